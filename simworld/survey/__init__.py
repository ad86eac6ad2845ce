"""Surveying a floor plan: which corridors and junctions it has, on which grid lines.

The way there: the space that the robot passes -> its skeleton -> a net of places and ways ->
stubs pruned, near places merged, corners found -> turned upright -> laid on grid lines.
"""

from simworld.survey.doors import Door, read_doors
from simworld.survey.errors import SurveyError
from simworld.survey.result import Corridor, Junction, Survey
from simworld.survey.surveying import DOOR_STUB_M, survey

__all__ = [
    "DOOR_STUB_M",
    "Corridor",
    "Door",
    "Junction",
    "Survey",
    "SurveyError",
    "read_doors",
    "survey",
]
