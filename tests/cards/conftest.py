"""Verdicts to show: realistic ones from ``verdicts/*.json`` and one that is hostile in every field."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from autograder.verdict import CriterionResult, Diagnosis, Moment, State, Verdict, from_json

if TYPE_CHECKING:
    from collections.abc import Callable

_VERDICTS = Path(__file__).parent / "verdicts"
_NAMES = sorted(path.stem for path in _VERDICTS.glob("*.json"))


def _load(name: str) -> Verdict:
    return from_json((_VERDICTS / f"{name}.json").read_bytes())


@pytest.fixture
def load() -> Callable[[str], Verdict]:
    """Read one of the sample verdicts by its name."""
    return _load


@pytest.fixture(params=[*_NAMES, "hostile"])
def verdict(request: pytest.FixtureRequest) -> Verdict:
    """Each sample verdict in turn, the hostile one too."""
    return _hostile() if request.param == "hostile" else _load(request.param)


@pytest.fixture
def hostile() -> Verdict:
    """What a subject could make the judge repeat: markup, control characters, too much of everything."""
    return _hostile()


def _hostile() -> Verdict:
    return Verdict(
        exercise="lab_1_2.talker",
        title="<script>alert('title')</script> & \"quotes\"",
        state=State.FAILED,
        score=1 / 3,
        max_score=1.0,
        criteria=(
            CriterionResult(
                name="topic",
                title="</td></table><img src=x onerror=alert(1)>",
                points=1.0,
                passed=False,
                expected="\x1b[31mred\x1b[0m\x00NUL",
                seen="\u202edesrever \u2066 " + "x" * 5000,
            ),
            CriterionResult("rtl", "שלום עולם 1 2 3", 0.0, True, "مرحبا", "l1\nl2\r\tl3"),
        ),
        diagnosis=Diagnosis(
            key="crashed",
            text="{{ 7*7 }} {% raw %} </style><script>alert(2)</script> $x^2$ and $y$",
            next_step="javascript:alert(3) \ud800 \u2028 end",
        ),
        remarks=("<b onmouseover=alert(4)>hover</b>",),
        timeline=(
            *(
                Moment(
                    t=0.001 * number,
                    lane=f"/lane{number % 30}",
                    direction="from_subject" if number % 3 else "strange<dir>\x07",
                    label="<svg onload=alert(5)>" + "y" * 3000,
                )
                for number in range(400)
            ),
            Moment(float("nan"), "nan", "note", "nan time"),
            Moment(-1.0, "neg", "note", "negative"),
            Moment(float("inf"), "inf", "to_subject", "inf"),
        ),
        seed="\"'><script>",
        seconds=3.0,
        detail="\x1b[1;31mBoom\x1b[0m\x07 <script>\n" + "line\n" * 400 + "z" * 9000,
    )
