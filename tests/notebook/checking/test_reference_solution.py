"""Who is shown a reference solution: a student with full marks, or one who has tried enough and then opens it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from autograder import check_journal, exercises
from autograder.cards.card_wording import OFFER, OUR_CHANGE, OWN_CHANGE, SOLUTION
from autograder.check_journal import JournalEntry
from autograder.messages.judge_messages import SOCKET_VARIABLE
from autograder.notebook.checking import card_display, subject_runs
from autograder.notebook.checking.card_display import solution_of
from autograder.notebook.checking.nbgrader_validation import VALIDATING
from autograder.student.handout import hand_out
from autograder.verdict import State, Verdict

ROOT = Path(__file__).resolve().parents[3]


@pytest.fixture
def shown(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> list[dict[str, str]]:
    """The cards that a notebook of a student's own has displayed or changed."""
    cards: list[dict[str, str]] = []
    monkeypatch.setenv(check_journal.VARIABLE, str(tmp_path / check_journal.NAME))

    class Shell:
        class events:  # noqa: N801
            @staticmethod
            def register(name: str, callback: Any) -> None: ...

    monkeypatch.delenv(SOCKET_VARIABLE, raising=False)
    monkeypatch.delenv(VALIDATING, raising=False)
    monkeypatch.setattr(card_display, "notebook_shell", lambda: Shell)
    monkeypatch.setattr(card_display, "display_card", cards.append)
    monkeypatch.setattr(card_display, "update_card", lambda handle, card: cards.append(card))
    monkeypatch.setattr(card_display, "_shown", {})
    monkeypatch.setattr(card_display, "_watching", [])
    return cards


def fail(*codes: str) -> None:
    for code in codes:
        check_journal.note(JournalEntry("check", "lab_1_2.talker", 1, 0, 10, code))


def check(score: float) -> None:
    state = State.PASSED if score == 10 else State.FAILED
    with card_display.CardDisplay("lab_1_2.talker", None) as place:
        place.show(Verdict("lab_1_2.talker", "The talker", state, score, 10))


@pytest.mark.parametrize("exercise", [one for one in exercises.all_ids() if exercises.get(one).enough])
def test_every_exercise_has_one_and_its_other_way_is_python(exercise: str) -> None:
    """A question has none: its right choice is all that there is to know."""
    solution = solution_of(exercise)
    assert solution is not None
    assert solution.code
    assert solution.why or any(solution.broken)
    assert bool(solution.other_way) == bool(solution.other_code)
    function = "\n".join(f"    {line}" for line in solution.other_code.splitlines())
    compile(f"def other_way():\n{function or '    pass'}", exercise, "exec")
    assert "SOLUTION" not in str(solution.code)


def test_full_marks_in_ones_own_notebook_offer_it(shown: list[dict[str, str]]) -> None:
    check(10)
    assert SOLUTION in shown[-1]["text/html"]


@pytest.mark.parametrize("score", [0, 9.5])
def test_less_does_not(shown: list[dict[str, str]], score: float) -> None:
    check(score)
    assert SOLUTION not in str(shown)


def test_after_five_attempts_a_button_opens_it_and_the_journal_says_so(shown: list[dict[str, str]]) -> None:
    fail(*"abcd")
    check(0)
    assert OFFER not in shown[-1]["text/html"]
    assert "Run the check again first" in card_display.open_solution("lab_1_2.talker")
    assert SOLUTION not in str(shown)
    fail("e")
    check(0)
    assert OFFER in shown[-1]["text/html"]
    assert SOLUTION not in str(shown)
    assert "at the end of the card" in card_display.open_solution("lab_1_2.talker")
    assert OFFER not in shown[-1]["text/html"]
    assert SOLUTION in shown[-1]["text/html"]
    entry = check_journal.entries(check_journal.session_journal_path())[-1]
    assert (entry.kind, entry.name) == ("solution", "lab_1_2.talker")
    # It stays while the student writes, and with the next check.
    dated = card_display._dated(card_display._shown["lab_1_2.talker"], "TalkerNode has changed")
    check(5)
    assert SOLUTION in dated["text/html"]
    assert SOLUTION in shown[-1]["text/html"]


def test_without_a_journal_it_stays_closed(
    shown: list[dict[str, str]], monkeypatch: pytest.MonkeyPatch
) -> None:
    fail(*"abcde")
    check(0)
    monkeypatch.setattr(check_journal, "note", lambda entry, journal=None: False)
    assert "cannot be written" in card_display.open_solution("lab_1_2.talker")
    assert SOLUTION not in str(shown)


def test_a_hand_out_offers_none(
    shown: list[dict[str, str]], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    hand_out(tmp_path / "course", ROOT)
    monkeypatch.setenv("AUTOGRADER_COURSE", str(tmp_path / "course"))
    fail(*"abcde")
    check(0)
    assert OFFER not in str(shown)


@pytest.mark.parametrize(
    ("variable", "value"), [(SOCKET_VARIABLE, "/somewhere/judge.socket"), (VALIDATING, "1")]
)
def test_while_a_class_is_graded_nothing_does(
    shown: list[dict[str, str]], monkeypatch: pytest.MonkeyPatch, variable: str, value: str
) -> None:
    monkeypatch.setenv(variable, value)
    check(10)
    assert shown
    assert SOLUTION not in str(shown)


@pytest.mark.parametrize("with_solutions", [False, True])
def test_a_hand_out_has_them_only_where_asked_for(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, with_solutions: bool
) -> None:
    place = tmp_path / "course"
    hand_out(place, ROOT, with_solutions=with_solutions)
    monkeypatch.setenv("AUTOGRADER_COURSE", str(place))
    assert (solution_of("lab_1_2.talker") is not None) == with_solutions
    assert not list(place.rglob("*.why.md"))


def test_a_repaired_class_is_shown_beside_ours(
    shown: list[dict[str, str]], monkeypatch: pytest.MonkeyPatch
) -> None:
    exercise = next(one for one in exercises.all_ids() if (given := solution_of(one)) and any(given.broken))
    solution = solution_of(exercise)
    assert solution is not None
    own = f"class Repaired:\n    def mine(self): pass\n{solution.code[0]}"
    monkeypatch.setattr(subject_runs, "_cells_of", lambda subject: {"your cell": own} if subject else {})
    with card_display.CardDisplay(exercise, object()) as place:
        place.show(Verdict(exercise, "A repair", State.PASSED, 4, 4))
    assert "+    def mine(self): pass" in shown[-1]["text/plain"]
    assert (OUR_CHANGE in str(shown), OWN_CHANGE in str(shown), SOLUTION in str(shown)) == (True, True, False)


def test_a_repaired_file_is_read_where_its_cell_has_written_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    given = "%%writefile setup.py\nbroken"
    assert subject_runs.own_text(given, "ros2_ws") == ""
    (tmp_path / "setup.py").write_text("repaired\n")
    assert subject_runs.own_text(given, "ros2_ws") == "%%writefile setup.py\nrepaired"
    assert subject_runs.own_text("class A: ...", "ros2_ws") == ""


@pytest.mark.parametrize("text", ["", "[]", "{}"])
def test_a_file_that_cannot_be_read_breaks_no_check(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, text: str
) -> None:
    lab = tmp_path / "solutions/chapter/lab_9_1"
    lab.mkdir(parents=True)
    (lab / "lab.md").touch()
    (lab / "battery.py").touch()
    (lab / "battery.solution.json").write_text(text)
    monkeypatch.setenv("AUTOGRADER_COURSE", str(tmp_path))
    assert solution_of("lab_9_1.battery") is None
    monkeypatch.setenv("AUTOGRADER_COURSE", str(tmp_path / "nothing"))
    assert solution_of("lab_9_1.battery") is None
