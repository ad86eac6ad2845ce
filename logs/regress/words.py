"""Changes of a run in words."""

from __future__ import annotations

from logs.regress.compare import DecisionChange, WorkChange
from logs.regress.summary import Decision


def decision_words(change: DecisionChange) -> str:
    """A changed decision: which one, and what of it."""
    one = change.new or change.base
    assert one is not None
    which = f"{one.kind} {one.decision} (visit {one.visit}, asked at {_s(change.asked_ns)})"
    if change.base is None:
        return f"{which}: not in base; {_settled(one)}"
    if change.new is None:
        return f"{which}: not in new; was {_settled(one)}"
    parts = [
        f"{name} {base} -> {new}"
        for name, base, new in zip(_NAMES, _facts(change.base), _facts(change.new), strict=True)
        if base != new
    ]
    return f"{which}: {', '.join(parts)}"


_NAMES = ("kind", "visit", "asked", "due", "decided", "slack", "size", "stood", "instead", "cause")


def _facts(one: Decision) -> tuple[str, ...]:
    came = one.decided_ns >= 0
    return (
        one.kind,
        str(one.visit),
        _s(one.asked_ns),
        _s(one.until_ns),
        _s(one.decided_ns) if came else "never",
        _s(one.slack_ns) if came else "none",
        str(one.size),
        _s(one.idle_ns),
        one.instead or "nothing",
        one.cause or "in time",
    )


def _settled(one: Decision) -> str:
    if one.decided_ns < 0:
        return f"never decided ({one.cause or 'no cause'})"
    return f"slack {_s(one.slack_ns)}" + (f", late: {one.cause}" if one.late else "")


def _s(time_ns: int) -> str:
    return f"{time_ns / 1e9:.9f}".rstrip("0").rstrip(".") + " s"


def work_words(change: WorkChange) -> str:
    """A handler whose work changed: times, cells and simulated time, those that did."""
    if change.base is None:
        assert change.new is not None
        return f"{change.name}: not in base; handled {change.new.times} times in new"
    if change.new is None:
        return f"{change.name}: handled {change.base.times} times in base, never in new"
    old, new = change.base, change.new
    parts = [
        f"{what} {a:,} -> {b:,}{_percent(a, b)}"
        for what, a, b in (
            ("handled", old.times, new.times),
            ("cells", old.cells, new.cells),
            ("busy ns", old.busy_ns, new.busy_ns),
        )
        if a != b
    ]
    return f"{change.name}: {', '.join(parts)}"


def _percent(base: float, new: float) -> str:
    return f" ({100.0 * (new / base - 1.0):+.2f} %)" if base else ""
