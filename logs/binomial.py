"""What so many successes out of so many say of a probability, exactly."""

from __future__ import annotations


def lower_bound(successes: int, trials: int, confidence: float) -> float:
    """The one-sided Clopper-Pearson bound from below; 0 for no success or no trial.

    C. J. Clopper and E. S. Pearson, Biometrika 26 (1934): the least probability under which as
    many successes, or more, are no rarer than 1 - confidence.
    """
    if successes == 0:
        return 0.0
    from scipy.special import betaincinv  # here, since scipy takes a while

    return float(betaincinv(successes, trials - successes + 1, 1.0 - confidence))


def upper_bound(successes: int, trials: int, confidence: float) -> float:
    """The one-sided Clopper-Pearson bound from above; 1 for nothing but successes."""
    return 1.0 - lower_bound(trials - successes, trials, confidence)


def interval(successes: int, trials: int, confidence: float) -> tuple[float, float]:
    """The two-sided Clopper-Pearson interval: both bounds, half of the error each."""
    one_side = 1.0 - (1.0 - confidence) / 2.0
    return lower_bound(successes, trials, one_side), upper_bound(successes, trials, one_side)


def trials_needed(probability: float, confidence: float) -> int:
    """How many trials, all of them successes, bring the bound from below up to ``probability``."""
    trials = 1
    while probability**trials > 1.0 - confidence:
        trials += 1
    return trials
