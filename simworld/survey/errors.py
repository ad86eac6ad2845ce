"""What can be wrong with a plan that is to be surveyed."""


class SurveyError(ValueError):
    """A plan without corridors, or a doors file that is none: file, found, expected."""
