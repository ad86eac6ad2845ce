"""Every message that the processes exchange.

One frozen structure a message; :mod:`bus.topics` says who publishes which and who listens.
Times are simulated nanoseconds since the run began, angles radians counter-clockwise from
east, headings and directions the bits N=1, E=2, S=4, W=8. A *visit* counts the stops at
locally distinctive places (LDPs); an *action* counts the sensing actions, 0 is "driving".
"""

from __future__ import annotations

import msgspec

from bus.fields import (
    Bytes1,
    Bytes2,
    Distribution,
    FiniteFloats,
    FiniteRows,
    FloatPairs,
    Floats,
    IntPairs,
    Ints,
    Matrix3,
    TypeBytes,
    TypeDistribution,
    TypeDistributions,
    TypeFloats,
    TypeInts,
    TypeLikelihood,
    TypePairs,
    TypeRows,
    Vector3,
)


class Message(msgspec.Struct, frozen=True, array_like=True, forbid_unknown_fields=True):
    """What every message is: frozen, compared by identity of its fields, packed as a list."""


# What the body senses.


class Odometry(Message, frozen=True):
    """Raw wheel counts since the last one, as distance and turn."""

    distance_m: float
    turn_rad: float
    elapsed_s: float


class Sonar(Message, frozen=True):
    """Raw echoes of one firing of the ring; NaN where none came back."""

    ping: int
    action: int
    fired_ns: int
    ranges_m: Floats


class Departure(Message, frozen=True):
    """The body leaves an LDP; ``visit`` is the stop it is heading for."""

    visit: int
    heading: int


class Arrival(Message, frozen=True):
    """The body stands at the port of an LDP, having driven a corridor."""

    visit: int
    heading: int
    drive_s: float


class Blocked(Message, frozen=True):
    """The body found a wall where it meant to leave, and is back where it was."""

    visit: int
    heading: int


class AtErrand(Message, frozen=True):
    """Whether somebody is here who expects the robot: whether this is the next ``waypoint``.

    Said to a robot that does not know where it is. Where it is, that is found out when the errand
    is seen to, and the decision of ``visit`` is asked for after it.
    """

    visit: int
    waypoint: int
    here: bool


class ActionEnded(Message, frozen=True):
    """The body finished the steps of a sensing action."""

    action: int


# What the modules believe.


class Ranges(Message, frozen=True):
    """Distribution of the range to the nearest surface while driving, one Gaussian a transducer.

    ``echo`` is the probability that the echo is a real one; where none came back, the mean is
    NaN and ``echo`` is 0. ``fired_ns`` is when the ring was fired.
    """

    ping: int
    fired_ns: int
    mean_m: Floats
    sigma_m: Floats
    echo: FiniteFloats
    speed_m_s: float


class Scan(Message, frozen=True):
    """The same for a ping of a sensing action: what its detector hears."""

    ping: int
    action: int
    mean_m: Floats
    sigma_m: Floats
    echo: FiniteFloats


class PoseBelief(Message, frozen=True):
    """Where the robot is relative to where it began: Gaussian over x, y and heading."""

    mean: Vector3
    covariance: Matrix3


class Reading(Message, frozen=True):
    """What detector d_{f,w} found: Pr(X_{f,w}) by its own lights, and the evidence class.

    ``wedge`` is one of ``wedges`` (:mod:`bus.features`).
    """

    visit: int
    action: int
    feature: int
    wedge: int
    probability: float
    evidence: int
    wedges: int


class JunctionPrior(Message, frozen=True):
    """pi(J) for the junction ahead: all that is known but this visit's readings."""

    visit: int
    x: int
    y: int
    heading: int
    prior: TypeDistribution


class JunctionLikelihood(Message, frozen=True):
    """lambda(J) = P(readings of this visit | junction type)."""

    visit: int
    likelihood: TypeLikelihood
    readings: int
    finished: bool


class JunctionStakes(Message, frozen=True):
    """What concluding one type (row) costs more where another (column) is true, in seconds.

    Of the junction at the end of ``visit``, by the errands still expected.
    """

    visit: int
    regret_s: TypePairs


class MapBelief(Message, frozen=True):
    """The posterior over all connected maps, as marginals and as a weighted set of maps.

    ``maps`` come grouped so that for each junction type at (x, y) any first few are an exact
    sample given that type. ``drive_s`` is the time to drive each corridor as far as known.
    Where the robot may be in several places it is the mixture over them, (x, y) being the
    likeliest, ``entropy`` that of place and map together; maps are then grouped by place first.
    """

    visit: int
    x: int
    y: int
    heading: int
    junctions: TypeDistributions
    corridors: FiniteFloats
    drive_s: FiniteFloats
    log_evidence: float
    entropy: float
    maps: Bytes2
    weights: Distribution
    log_probability: FiniteFloats


class Registrations(Message, frozen=True):
    """Where the robot may be at the end of ``visit``: a row for each registration that is left.

    ``places`` are the intersections ahead, ``weights`` their probabilities, ``ahead`` what each
    says of the type there. ``corridors`` and ``drive_s`` are as in :class:`MapBelief`, and so are
    the maps, ``of`` one registration each; ``map_weights`` sum to one for each.
    """

    visit: int
    heading: int
    places: Ints
    weights: Distribution
    ahead: TypeRows
    corridors: FiniteRows
    drive_s: FiniteRows
    of: Ints
    maps: Bytes2
    map_weights: FiniteFloats
    log_probability: FiniteFloats


# What is asked, decided and commanded.


class AskedSensing(Message, frozen=True):
    """Which feature to test after ``action``? Due at its end."""

    decision: int
    visit: int
    action: int
    asked_ns: int
    until_ns: int


class AskedPath(Message, frozen=True):
    """Which corridor to take from the LDP of ``visit``? Due on arrival there.

    ``waypoints`` are the goals still to be reached, the current one first; ``tasks`` (start,
    goal) with ``expected`` numbers are the errands that may come.
    """

    decision: int
    visit: int
    waypoints: Ints
    tasks: IntPairs
    expected: FiniteFloats
    asked_ns: int
    until_ns: int


class AskedErrand(Message, frozen=True):
    """When the errand that :class:`AskedPath` of ``visit`` is for is due, if it is, at its goal.

    Each second later costs ``late_price`` seconds more.
    """

    visit: int
    due_ns: int
    late_price: float


class AskedReaction(Message, frozen=True):
    """Something approaches (kept for the ledger: the reactor must notice by itself)."""

    decision: int
    encounter: int
    asked_ns: int
    until_ns: int


class SensingDecision(Message, frozen=True):
    """For each outcome of the running action: the next detector, or -1 and the type concluded.

    ``worth_s`` is what testing on is expected to save for each outcome, its time paid for; plans
    held at most ``look_ahead`` tests.
    """

    decision: int
    visit: int
    action: int
    next_detector: Ints
    concluded: Ints
    worth_s: FiniteFloats
    look_ahead: int


class PathDecision(Message, frozen=True):
    """For each junction type at the far end: the way out (0: stay) and both expected values.

    ``known_s`` is E[P_K], ``unknown_s`` E[P_U] of the best exploratory step; both may be inf.
    """

    decision: int
    visit: int
    direction: TypeBytes
    known_s: TypeFloats
    unknown_s: TypeFloats
    explores: TypeBytes
    hypotheses: int


class RegistrationDecision(Message, frozen=True):
    """Is this the same intersection? Why the path of a robot is as it is that may be in several.

    For each junction type at the far end: expected cost in seconds of acting at once (``now_s``)
    and of looking somewhere first (``look_s``, infinite where there is nothing to look at), and
    whether it makes that ``detour``. ``acts_at``: the intersection that it acts as if it were at;
    ``looks_at``: where it looks first, as seen from there, or -1. For types of which no map has
    one, both costs are infinite and both places -1.
    """

    decision: int
    visit: int
    now_s: TypeFloats
    look_s: TypeFloats
    detour: TypeBytes
    acts_at: TypeInts
    looks_at: TypeInts


class ReactionDecision(Message, frozen=True):
    """What to do about an approaching object, with the expected utility of every act.

    ``fired_ns`` is when the ring was fired of whose echoes this is the consequence; ``aside_m``
    how far off the centre line an act that goes aside goes.
    """

    act: str
    expected_utility: FiniteFloats
    approaching: float
    fired_ns: int
    aside_m: float


class Motion(Message, frozen=True):
    """The steps of a sensing action: rows of (kind, amount), kinds as in DRIVE, TURN, PING.

    ``after`` is the action before it at the same LDP, 0 if it is the first there.
    """

    visit: int
    after: int
    action: int
    detector: int
    steps: FloatPairs


DRIVE, TURN, PING = 0, 1, 2
"""Kinds of motion steps: metres, radians, number of firings of the ring."""


class Attention(Message, frozen=True):
    """How often to fire the ring while driving."""

    period_s: float


# What the clock and the deadlines leave behind.


class DeadlineMissed(Message, frozen=True):
    """A decision was not heard by its deadline; said at exactly that moment."""

    decision: int
    kind: str
    until_ns: int


class LedgerEntry(Message, frozen=True):
    """What became of one decision. ``decided_ns`` is -1 when it never came."""

    decision: int
    kind: str
    visit: int
    asked_ns: int
    until_ns: int
    decided_ns: int
    slack_ns: int
    cells: int
    size: int
    idle_ns: int
    instead: str
    cause: str


class Span(Message, frozen=True):
    """One handler's work: what it handled, when it began and ended, the cells it touched."""

    process: str
    topic: str
    source: str
    sequence: int
    start_ns: int
    end_ns: int
    cells: int


class WallSpan(Message, frozen=True):
    """What one handler really took, beside what the compute profile says. Only in RUN.wall.mcap."""

    process: str
    topic: str
    about_source: str
    about_sequence: int
    cells: int
    modelled_ns: int
    took_ns: int


class ProcessState(Message, frozen=True):
    """What a process does from now on: ``running``, ``down`` or ``ended``."""

    process: str
    state: str


class Output(Message, frozen=True):
    """What a handler printed."""

    process: str
    text: str


class Refused(Message, frozen=True):
    """A message that was not let in, and why; ``count`` of them so far.

    ``source`` and ``sequence`` are what it claimed, "" and -1 where that could not be read.
    """

    topic: str
    source: str
    sequence: int
    reason: str
    count: int


class RunEnded(Message, frozen=True):
    """Why the run ended: ``done``, ``time``, ``stuck``, ``stopped`` or ``process down: NAME``."""

    reason: str


# What really is: for the recorder alone.


class TrueBuilding(Message, frozen=True):
    """The building and who walks in it."""

    columns_m: FiniteFloats
    rows_m: FiniteFloats
    corridor_width_m: float
    corridors: Bytes1
    start: int


class TruePose(Message, frozen=True):
    """Where the robot really is."""

    x_m: float
    y_m: float
    heading_rad: float
    place: int


class TrueErrand(Message, frozen=True):
    """An errand was done; ``shortest_s`` is the time of the shortest possible way."""

    errand: int
    start: int
    goal: int
    began_ns: int
    ended_ns: int
    shortest_s: float


class TrueEncounter(Message, frozen=True):
    """How a meeting with somebody in a corridor went."""

    encounter: int
    collided: bool
    closest_m: float
    delay_s: float
