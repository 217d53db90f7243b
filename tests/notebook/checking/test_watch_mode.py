"""Watch mode in a kernel, by a judge that does what the test says: what is shown below which cell, and when."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import pytest

from autograder.messages.judge_messages import SOCKET_VARIABLE
from autograder.notebook.checking import watch_mode
from tests.cases import cases

if TYPE_CHECKING:
    from collections.abc import Iterator

LIMIT = 180.0
"""Seconds after which a test gives up waiting for a card."""

# The judge answers at once, unless `patient` is set: then its check goes on until somebody hangs up.
JUDGE = cases(__file__, "JUDGE")
TALKER = "class Talker:\n    text = {!r}"


@dataclass
class Watched:
    """A kernel, and the cards that came of its cells: by display, the texts that stood there one after the other."""

    kernel: Any
    cards: dict[str, list[str]] = field(default_factory=dict)

    def run(self, source: str, cell: str) -> None:
        """Run a cell to its end."""
        request = self.kernel.begin(source, cell)
        while not self._hear(request):
            pass

    def wait_for(self, text: str) -> str:
        """Wait for a card with this text; all of the card."""
        while not any(text in shown[-1] for shown in self.cards.values()):
            self._hear("")
        return next(shown[-1] for shown in self.cards.values() if text in shown[-1])

    def updates(self, number: int) -> list[str]:
        """Wait for so many more updates of the only card; their texts."""
        (shown,) = self.cards.values()
        first = len(shown)
        while len(shown) < first + number:
            self._hear("")
        return shown[first:]

    def _hear(self, request: str) -> bool:
        message = self.kernel.client.get_iopub_msg(timeout=LIMIT)
        kind, content = message["msg_type"], message["content"]
        assert kind != "error", content
        if kind == "display_data":
            self.cards[content["transient"]["display_id"]] = [content["data"]["text/plain"]]
        elif kind == "update_display_data":
            self.cards[content["transient"]["display_id"]].append(content["data"]["text/plain"])
        idle = kind == "status" and content["execution_state"] == "idle"
        return bool(idle and message["parent_header"].get("msg_id") == request)


@pytest.fixture
def watched(notebook: Any) -> Iterator[Watched]:
    found = Watched(notebook)
    found.run(JUDGE, "judge")
    found.run(TALKER.format("one"), "talker")
    found.run("scores[:] = [5.0, 10.0]; watch('lab', Talker)", "watch")
    yield found
    found.run("patient.clear(); unwatch()", "end")


def test_a_class_that_is_defined_anew_is_checked_and_its_card_is_short(watched: Watched) -> None:
    assert watched.cards == {}, "nothing is checked before its cell is run again"
    watched.run(TALKER.format("two"), "talker")
    card = watched.wait_for("5 of 10 points")
    assert "It says b." in card
    assert "Say a." in card
    assert "Criteria" not in card
    (shown,) = watched.cards.values()
    assert "as soon as this cell has ended" in shown[0]
    assert "run 1 of two" in shown[-2]

    watched.run(TALKER.format("three"), "talker")
    assert "10 of 10 points, 5 before" in watched.wait_for("10 of 10 points")
    assert len(watched.cards) == 2, "one for each run of the cell, whose earlier outputs are gone"


def test_another_cell_does_not_wait_for_a_check_which_begins_again_afterwards(watched: Watched) -> None:
    watched.run("patient.set()", "other")
    watched.run(TALKER.format("two"), "talker")
    watched.wait_for("run 1 of two")
    watched.run("patient.clear()", "other")
    watched.wait_for("5 of 10 points")
    (shown,) = watched.cards.values()
    assert any("as soon as the running cell has ended" in text for text in shown)


def test_a_check_that_goes_on_tells_its_time_and_after_half_a_minute_what_is_known(watched: Watched) -> None:
    watched.run("patient.set(); card_display.SOON = 0.01", "other")
    watched.run(TALKER.format("two"), "talker")
    watched.wait_for("run 1 of two")
    shown = watched.updates(3)
    assert all("Checking: run 1 of two" in text for text in shown)
    assert not any("It says b." in text for text in shown)
    watched.run("card_display.LONG = 0.0; patient.clear(); scores.insert(0, 5.0)", "other")
    watched.run("patient.set()", "other")
    watched.run(TALKER.format("three"), "talker")
    assert "run 1 of three" in watched.wait_for("So far: “It says b.”")


def test_nothing_is_checked_after_unwatch(watched: Watched) -> None:
    watched.run("unwatch()", "other")
    watched.run(TALKER.format("two"), "talker")
    watched.run("assert scores == [5.0, 10.0]", "other")
    assert watched.cards == {}


def test_a_call_in_the_cell_of_the_class_itself_watches_it_too(watched: Watched) -> None:
    watched.run(TALKER.format("two") + "\nwatch('lab', Talker)", "talker")
    watched.wait_for("5 of 10 points")


def test_other_cells_bring_no_card(watched: Watched) -> None:
    watched.run("Talker().text, 1 + 1", "other")
    assert watched.cards == {}


@pytest.mark.parametrize("variable", [SOCKET_VARIABLE, "NBGRADER_VALIDATING"])
def test_nothing_is_watched_while_a_class_is_graded_or_validated(notebook: Any, variable: str) -> None:
    graded = Watched(notebook)
    graded.run(JUDGE, "judge")
    graded.run(TALKER.format("one"), "talker")
    graded.run(f"import os; os.environ[{variable!r}] = '1'; begun = watch('graded', Talker)", "watch")
    graded.run(f"del os.environ[{variable!r}]", "other")
    graded.run(TALKER.format("two"), "talker")
    graded.run("assert repr(begun) == 'Talker is not watched.', begun", "other")
    assert graded.cards == {}


def test_only_what_has_a_cell_can_be_watched() -> None:
    with pytest.raises(TypeError, match=r"watch\('lab', …\) takes your class or function"):
        watch_mode.watch("lab", "ros2_ws")  # type: ignore[arg-type]


CHECKED = """
from types import SimpleNamespace
scores[:] = [5.0, 10.0]
watch_mode.watch_after(converse(None, "lab", Talker, SimpleNamespace(doing=str)), Talker)
"""


def test_watching_begins_by_itself_after_a_check_that_showed_something_to_mend_until_the_student_ends_it(
    notebook: Any,
) -> None:
    found = Watched(notebook)
    found.run(JUDGE + "watch_mode._ended_by_the_student = False", "judge")
    found.run(TALKER.format("one"), "talker")
    found.run(CHECKED, "check")
    found.run(TALKER.format("two"), "talker")
    assert "10 of 10 points" in found.wait_for("10 of 10 points")
    found.run(
        "assert watch_mode.switch('lab', Talker) == 'Talker is no longer checked automatically.'", "button"
    )
    found.run(CHECKED, "check")
    found.run(TALKER.format("three"), "talker")
    assert len(found.cards) == 1, "the student has ended it"
    found.run("assert 'whenever its cell is run' in watch_mode.switch('lab', Talker)", "button")
    found.run(TALKER.format("four"), "talker")
    while sum("10 of 10 points" in shown[-1] for shown in found.cards.values()) < 2:
        found._hear("")  # to its end: a check that goes on would take the next test's score
    found.run("unwatch()", "end")


CHECK_CELL = """
from autograder.notebook.checking.card_display import CardDisplay
scores[:] = [5.0, 10.0]
with CardDisplay("lab", Talker) as place:
    place.show(converse(None, "lab", Talker, place.progress))
watch("lab", Talker)
"""


def test_the_card_of_the_check_cell_follows_what_is_watched(notebook: Any) -> None:
    found = Watched(notebook)
    found.run(JUDGE, "judge")
    found.run(TALKER.format("one"), "talker")
    found.run(CHECK_CELL, "check")
    (checked,) = found.cards
    assert "5 of 10 points" in found.cards[checked][-1]
    found.run(TALKER.format("two"), "talker")
    while "10 of 10 points, 5 before" not in found.cards[checked][-1]:
        found._hear("")
    assert "has changed since this check" not in found.cards[checked][-1]
    found.run(
        "unwatch()\nfrom autograder.notebook.checking import card_display\ncard_display._shown.clear()", "end"
    )


def test_what_a_check_by_hand_has_found_is_not_looked_for_again(watched: Watched) -> None:
    watched.run("patient.set()", "other")
    watched.run(TALKER.format("two"), "talker")
    watched.wait_for("run 1 of two")
    by_hand = """
patient.clear()
scores[:] = [7.0]
watch_mode.watch_after(converse(None, "lab", Talker, SimpleNamespace(doing=str)), Talker)
"""
    watched.run("from types import SimpleNamespace" + by_hand, "check")
    assert "7 of 10 points" in watched.wait_for("7 of 10 points")
    watched.run("assert watch_mode._watches._thread is None", "other")
