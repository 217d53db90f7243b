"""What the short tier leaves out, and that each name in its lists is a test's."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from tests import tiers
from tests.turns import SHORT, Draw

if TYPE_CHECKING:
    import pytest

BANK = "tests/judge/test_bank.py::test_answer_is_judged_right["
IDS = [f"{BANK}lab.{exercise}/right/{number}.py]" for exercise in "ab" for number in range(9)]


def test_as_many_of_each_group_are_drawn_and_other_ones_by_another_word(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    chosen = []
    for word in ("0123456789ab", "0123456789ab", "ba9876543210"):
        monkeypatch.setenv(tiers.SEED, word)
        chosen.append(set(IDS) - tiers.left_to_all(IDS, []))
    assert chosen[0] == chosen[1] != chosen[2]
    assert [sum(f"lab.{exercise}/" in one for one in chosen[0]) for exercise in "ab"] == [1, 1]


def test_no_draw_is_spent_on_what_is_left_to_all(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(tiers, "NIGHTLY", tuple(IDS[:8]))
    assert set(IDS[:9]) - tiers.left_to_all(IDS, []) == {IDS[8]}


def test_the_short_tier_runs_fewer_of_what_is_drawn_and_all_that_is_due(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(tiers, "SHORT", (Draw((f"{BANK}lab.a", f"{BANK}lab.b"), 1),))
    assert len(set(IDS) - tiers.never_drawn(IDS)) == 2
    assert len(set(IDS) - tiers.left_to_all(IDS, [])) == 1
    assert not tiers.left_to_all(IDS, IDS)


def test_tests_that_share_what_is_made_are_drawn_together(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(tiers, "SHORT", ())
    monkeypatch.setattr(tiers, "DRAWS", (Draw((f"{BANK}lab.a", f"{BANK}lab.b"), 1, whole=True),))
    kept = set(IDS) - tiers.left_to_all(IDS, [])
    assert len(kept) == 9
    assert len({one.partition("/right")[0] for one in kept}) == 1


def test_what_is_due_runs_whatever_is_drawn() -> None:
    assert not tiers.left_to_all(IDS, IDS)
    assert len(tiers.left_to_all(IDS, IDS[:9])) == 8


def test_every_name_in_the_lists_is_a_tests(request: pytest.FixtureRequest) -> None:
    draws = (*tiers.DRAWS, *SHORT, *tiers.SMOKE, *tiers.LONG)
    names = [*tiers.NIGHTLY, *(one for draw in draws for one in draw.beginnings)]
    root = Path(__file__).parents[1]
    missing = [name for name in names if not (root / name.partition("::")[0]).exists()]
    functions = [name.partition("::") for name in names if "::" in name]
    missing += [
        f"{file}::{test}"
        for file, _, test in functions
        if f"def {test.partition('[')[0]}" not in (root / file).read_text(encoding="utf-8")
    ]
    assert missing == []


def test_whoever_names_tests_gets_all_of_them() -> None:
    command = [
        sys.executable,
        "-m",
        "pytest",
        "--collect-only",
        "-p",
        "no:cacheprovider",
        "tests/test_tiers.py",
    ]
    done = subprocess.run(command, cwd=Path(__file__).parents[1], capture_output=True, text=True, check=False)
    assert "tier: all" in done.stdout
