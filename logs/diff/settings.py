"""What two runs were made from, where that differs: scenario, seed, changes, versions, prices."""

from __future__ import annotations

from difflib import SequenceMatcher
from pathlib import Path

from logs.diff.contents import FieldDifference, shown
from logs.reader import read_run


def setting_differences(base: str | Path, new: str | Path) -> tuple[FieldDifference, ...]:
    """What the heads of two logs say differently. Raises LogReadError."""
    with read_run(base) as of_base, read_run(new) as of_new:
        facts = of_base.metadata, of_new.metadata
        files = of_base.attachments, of_new.attachments
    found: list[FieldDifference] = []
    for name in dict.fromkeys((*facts[0], *facts[1])):
        pair = [of.get(name, "nothing") for of in facts]
        if pair[0] != pair[1]:
            found.append(FieldDifference(name, *_without_common(*pair)))
    for name in dict.fromkeys((*files[0], *files[1])):
        texts = [of.get(name, b"").decode(errors="replace").splitlines() for of in files]
        found += _lines(name, *texts)
    return tuple(found)


def _without_common(base: str, new: str) -> tuple[str, str]:
    """Of two lists, what is in one only; other texts as they are."""
    parts = [text.replace("\n", ", ").split(", ") for text in (base, new)]
    only = [", ".join(p for p in parts[k] if p not in parts[1 - k]) for k in (0, 1)]
    return shown(only[0] or "nothing"), shown(only[1] or "nothing")


def _lines(name: str, base: list[str], new: list[str]) -> list[FieldDifference]:
    matcher = SequenceMatcher(None, base, new, autojunk=False)
    return [
        FieldDifference(f"{name}:{a + 1}", _joined(base[a:b]), _joined(new[c:d]))
        for how, a, b, c, d in matcher.get_opcodes()
        if how != "equal"
    ]


def _joined(lines: list[str]) -> str:
    return shown(" ".join(line.strip() for line in lines) or "nothing")
