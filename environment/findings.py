"""The doctor's finding about one thing."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

if TYPE_CHECKING:
    from collections.abc import Iterable

# ok: it is there and works.  missing: the course needs it.  optional: not there, and only a part needs it.
# unchecked: could not be found out, because something else is missing.
State = Literal["ok", "missing", "optional", "unchecked"]

_SIGN = {"ok": "ok", "missing": "MISSING", "optional": "optional", "unchecked": "not checked"}


@dataclass(frozen=True)
class Finding:
    """One thing that the course needs or can use.

    Attributes:
        name: the thing.
        state: how it stands with it.
        detail: what was found: a version, a path, what was wrong.
        remedy: how to get it; empty where nothing needs doing.
    """

    name: str
    state: State
    detail: str
    remedy: str = ""


def exit_code(findings: Iterable[Finding]) -> int:
    """Return 0 if everything that the course needs is there, else 1."""
    return 1 if any(finding.state == "missing" for finding in findings) else 0


def as_text(findings: Iterable[Finding]) -> str:
    """Return the findings as lines for a terminal: the state, the thing, the detail, then the remedy."""
    lines = []
    for finding in findings:
        lines.append(f"{_SIGN[finding.state]:<12} {finding.name}: {finding.detail}")
        if finding.remedy:
            lines.append(f"{'':<12}   {finding.remedy}")
    return "\n".join(lines)
