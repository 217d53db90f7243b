"""The two tiers: what ``./course test`` runs, and what only ``./course test --all`` does. Decided here alone.

A test that is named here is left to ``--all``; of those that are drawn, some run each day, and all that are marked
``due``: something that they depend on has changed. Whoever names files or folders of tests gets all of them.
"""

from __future__ import annotations

import os
from collections import defaultdict
from dataclasses import dataclass
from datetime import UTC, datetime
from random import Random
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    import pytest

DAY = "COURSE_TEST_DAY"
"""The variable that repeats the draw of a day, such as ``2026-11-23``."""

NIGHTLY: dict[str, str] = {}
"""Beginnings of the ids of tests that only ``--all`` runs, and why that is enough."""


@dataclass(frozen=True)
class Draw:
    """Tests of which some run each day.

    Attributes:
        tests: The beginning of their ids.
        number: How many of each group.
        group: What ends the name of a group in an id; all are one group where empty.
    """

    tests: str
    number: int
    group: str = ""


DRAWS = (
    Draw("tests/judge/test_bank.py::test_answer_is_judged_right[", 4, "/"),
    Draw("tests/attacks/test_attacks.py::test_it_is_defeated[", 1, "-"),
    Draw("tests/test_recording.py::test_recording_again_gives_the_same_file[", 2),
    Draw("tests/execution/test_notebooks.py::test_master_and_chapter_show_what_they_have_to[", 2),
)


def day() -> str:
    """The day that decides on what is drawn: today, in UTC, or the one that the variable names."""
    return os.environ.setdefault(DAY, datetime.now(UTC).date().isoformat())


def drawn(names: Iterable[str], number: int) -> set[str]:
    """So many of these names, other ones each day."""
    listed = sorted(names)
    return set(Random(f"{day()} {listed[0]}").sample(listed, min(number, len(listed)))) if listed else set()


def asked_for(request: pytest.FixtureRequest, parameter: str) -> list[Any]:
    """The values of a parameter in the tests of this session that use the fixture which asks."""
    asking = [
        item for item in request.session.items if request.fixturename in getattr(item, "fixturenames", ())
    ]
    params = [getattr(item, "callspec").params for item in asking if hasattr(item, "callspec")]  # noqa: B009
    return [own[parameter] for own in params if parameter in own]


def left_to_all(ids: Sequence[str], due: Iterable[str]) -> set[str]:
    """The ids of the tests that the short tier leaves out.

    Args:
        ids: Of all tests.
        due: Of those that run whatever is drawn.
    """
    left = {one for one in ids if any(one.startswith(name) for name in NIGHTLY)}
    for draw in DRAWS:
        groups: dict[str, list[str]] = defaultdict(list)
        for one in ids:
            if one.startswith(draw.tests):
                rest = one.removeprefix(draw.tests)
                groups[rest.partition(draw.group)[0] if draw.group else ""].append(one)
        for group in groups.values():
            left |= set(group) - drawn(group, draw.number)
    return left - set(due)
