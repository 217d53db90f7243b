"""The bank itself: what its files say is there and of use, and each demand can fail."""

from __future__ import annotations

import contextlib
import gzip
import os
import sqlite3
import sys
import zlib
from collections import Counter
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

sys.path.append(str(Path(__file__).parent))  # not first: other folders have a conftest, too

from attack_bank import FAMILIES, HERE, Attack, attacks
from attack_class import HONEST, Graded, Traps
from attack_demands import general_objections, objections
from planting import plant

from autograder import exercises

if TYPE_CHECKING:
    from collections.abc import Iterator

BANK = list(attacks())
ROW = {"assignment": "lab_1_2", "state": "failed", "score": "0", "reason": "", "diagnosis": ""}


def test_there_are_at_least_sixty_in_every_family() -> None:
    families = Counter(attack.family for attack in BANK)
    assert len(BANK) >= 60
    assert set(families) == set(FAMILIES)
    assert min(families.values()) >= 3


@pytest.mark.parametrize("attack", BANK, ids=lambda attack: attack.name)
def test_its_file_says_what_it_is(attack: Attack) -> None:
    assert attack.tries.endswith(".")
    assert attack.could_earn.endswith(".")
    assert set(attack.earned) <= set(exercises.all_ids())
    assert attack.boxed_only or attack.undefended or attack.is_program
    assert attack.is_program or attack.cells()


def test_names_are_students_names_and_nobody_has_two() -> None:
    names = [attack.name for attack in BANK]
    assert len(set(names)) == len(names)
    assert not set(names) & set(HONEST)


def test_no_file_of_the_bank_is_left_out() -> None:
    assert len(BANK) == len([path for path in HERE.glob("[bc]*/**/*.py") if "__pycache__" not in path.parts])


# --- each demand can fail ----------------------------------------------------------------------------------


@pytest.fixture
def traps(tmp_path: Path) -> Iterator[Traps]:
    with Traps(tmp_path) as laid:
        yield laid


@pytest.fixture
def attack() -> Attack:
    return Attack("mallory", HERE / "none.py", "forging", "It tries.", "It could earn.")


@pytest.fixture
def graded(tmp_path: Path) -> Graded:
    rows = {
        student: {name: {**ROW, "score": str(p)} for name, p in points.items()}
        for student, points in HONEST.items()
    }
    page = tmp_path / "class" / "feedback" / "mallory" / "lab" / "lab.html"
    page.parent.mkdir(parents=True)
    page.write_text('<pre>print("LEAK: in its own source")</pre>\n<pre>nothing</pre>')
    return Graded(tmp_path / "class", 0, "", 1.0, {**rows, "mallory": {"lab_1_2.talker": ROW}})


def write_page(graded: Graded, text: str) -> None:
    (graded.path / "feedback" / "mallory" / "lab" / "lab.html").write_text(text)


def test_a_defeated_attack_meets_no_objection(attack: Attack, graded: Graded, traps: Traps) -> None:
    assert objections(attack, graded, traps) == []
    assert general_objections([], graded, traps) == []


@pytest.mark.parametrize(
    ("row", "word"),
    [({"score": "3"}, "3 points"), ({"state": "not_checked", "reason": "trouble"}, "not_checked")],
)
def test_an_unearned_point_is_seen(
    attack: Attack, graded: Graded, traps: Traps, row: dict[str, str], word: str
) -> None:
    graded.rows["mallory"]["lab_1_2.talker"] = {**ROW, **row}
    assert word in " ".join(objections(attack, graded, traps))


def test_a_missing_row_and_a_missing_earned_point_are_seen(
    attack: Attack, graded: Graded, traps: Traps
) -> None:
    assert objections(replace(attack, earned={"lab_1_2.talker": 3}), graded, traps)
    del graded.rows["mallory"]
    assert objections(attack, graded, traps)


@pytest.mark.parametrize(
    "page",
    [
        "<pre>LEAK: connected to 22</pre>",
        "<pre>canary-of-the-neighbour-b7731e</pre>",
        "<script>attack_canary()</script>",
        "<p onclick='attack_canary()'>x</p>",
        "<a href='javascript:attack_canary()'>x</a>",
        "<iframe srcdoc='attack_canary'></iframe>",
    ],
)
def test_what_must_not_stand_in_a_page_is_seen(
    attack: Attack, graded: Graded, traps: Traps, page: str
) -> None:
    write_page(graded, page)
    assert len(objections(attack, graded, traps)) == 1


def test_a_visit_outside_is_seen(attack: Attack, graded: Graded, traps: Traps) -> None:
    traps.visitors.append("mallory was here")
    assert objections(attack, graded, traps)
    assert general_objections([], graded, traps)


def test_a_planted_secret_is_seen_wherever_it_comes_out_of_a_box(
    attack: Attack, graded: Graded, traps: Traps
) -> None:
    traps.planted = {"a solution": "planted-0123456789abcdef"}
    assert general_objections([], graded, traps) == []
    write_page(graded, "<pre>planted-0123456789abcdef</pre>")
    assert len(general_objections([], graded, traps)) == 1
    write_page(graded, "")
    (graded.path / ".autograder").mkdir()
    packed = zlib.compress(b"before " + gzip.compress(b"LEAK: mallory planted-0123456789abcdef") + b" behind")
    with sqlite3.connect(graded.path / ".autograder" / "class.db") as store:
        store.execute("CREATE TABLE evidence (data)")
        store.execute("INSERT INTO evidence VALUES (?)", [packed])
    assert len(general_objections([], graded, traps)) == 1
    assert objections(attack, graded, traps) == []
    assert len(objections(replace(attack, says="LEAK: mallory"), graded, traps)) == 1


def test_an_attack_that_was_never_run_is_seen(attack: Attack, graded: Graded, traps: Traps) -> None:
    assert len(objections(replace(attack, says="I was run"), graded, traps)) == 1


def test_each_planted_text_disappears_again(tmp_path: Path) -> None:
    words = {
        f"<<{word}>>": str(tmp_path / word)
        for word in ("environment", "repository", "class", "home", "reference")
    }
    for own in (tmp_path / "reference", tmp_path / "class" / ".autograder" / "secret"):
        own.parent.mkdir(parents=True, exist_ok=True)
        own.write_text("own")
    before = sorted(tmp_path.rglob("*"))
    with contextlib.ExitStack() as at_end:
        planted = plant({**words, "<<random>>": f"test_{os.getpid()}"}, at_end)
        assert all(path.is_file() for path in planted.paths)
        assert len(planted.secrets) == len(planted.paths) + len(planted.variables)
    (tmp_path / "class" / "gradebook.db").unlink()
    assert sorted(tmp_path.rglob("*")) == before


def test_what_goes_wrong_with_the_batch_is_seen(graded: Graded, traps: Traps, tmp_path: Path) -> None:
    assert general_objections([], replace(graded, exit_code=2), traps)
    assert general_objections([], replace(graded, rows={}), traps)
    assert general_objections([], replace(graded, before={"a file": "1"}, after={"a file": "2"}), traps)
    left = Path("/tmp/attack_canary_of_a_test")
    left.touch()
    try:
        assert general_objections([], graded, traps)
    finally:
        left.unlink()
