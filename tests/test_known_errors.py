"""The table of known errors: each row has a source that it matches, and real exceptions get what is written here."""

from __future__ import annotations

import functools
import json
import subprocess
import sys
from typing import TYPE_CHECKING

import pytest

from autograder import course, known_errors
from autograder.authoring.answer_bank import Answer, answers
from autograder.judge import evidence_files
from autograder.kit.mistakes.crashes import traceback_of
from autograder.kit.mistakes.package_mistakes import build_report
from autograder.kit.mistakes.runner_mistakes import complaint
from autograder.notebook.nodes import ros_session
from tests.cases import cases
from tests.measure import evidence as kept_evidence

if TYPE_CHECKING:
    from autograder.known_errors import KnownError

SETTING = cases(__file__, "SETTING")
SAYS = cases(__file__, "SAYS")
NOTHING = cases(__file__, "NOTHING")


@pytest.fixture(scope="module")
def shown() -> dict[str, str]:
    """The traceback of each piece of code in a process with ROS; empty if it ended with none."""
    codes = json.dumps([*SAYS, *NOTHING])
    run = subprocess.run([sys.executable, "-c", SETTING], input=codes, capture_output=True, text=True)
    found: dict[str, str] = json.loads(run.stdout.splitlines()[-1])
    return found


@pytest.mark.parametrize(("code", "words"), SAYS.items())
def test_a_real_exception_is_named_with_what_is_written_here(
    shown: dict[str, str], code: str, words: str
) -> None:
    row = known_errors.recognized(shown[code], "cell", "my_robot_interfaces")
    assert row is not None, shown[code]
    assert words in f"{row.means} {row.do}"


@pytest.mark.parametrize("code", NOTHING)
def test_nothing_is_said_of_other_code(shown: dict[str, str], code: str) -> None:
    assert known_errors.recognized(shown[code], "cell", "my_robot_interfaces") is None


ROWS = known_errors.rows()
BANK = {answer.name: answer for answer in answers()}


def sources(row: KnownError) -> list[str]:
    """The sources of a row: addresses, answers of the bank, files of this repository."""
    return [row.source] if isinstance(row.source, str) else row.source


@functools.cache
def heard(answer: Answer) -> dict[str, str]:
    """What was heard of an answer, by where: its traceback, its output, its build's line and its launch's error."""
    line = kept_evidence.kept(answer.exercise).get(answer.name)
    record = kept_evidence.record_of(answer, line)
    evidence = evidence_files.evidence_of(record.seen, evidence_files.load_reference(answer.exercise))
    report = build_report(evidence.main)
    return {
        "program": traceback_of(evidence),
        "terminal": "\n".join(text for part in evidence for text in part.said()),
        "build": report.line if report else "",
        "launch": complaint(evidence.main),
    }


def deciding(row: KnownError, said: dict[str, str]) -> bool:
    """Whether a row is the first that matches what was heard, in one of its places."""
    return any(
        next(
            (one for one in ROWS if place in one.heard and known_errors.pattern_of(one).search(said[place])),
            None,
        )
        is row
        for place in row.heard
        if said.get(place)
    )


@pytest.mark.parametrize("row", ROWS, ids=lambda row: f"{row.key}: {row.means[:40]}")
def test_each_row_has_a_source_that_it_matches(row: KnownError) -> None:
    assert sources(row)
    for source in sources(row):
        if source.startswith("https://"):
            continue
        if source in BANK:
            assert deciding(row, heard(BANK[source])), f"another row decides on {source}"
        else:
            message = known_errors.pattern_of(row).pattern.rpartition(")")[2]
            assert message in (course.root() / source).read_text(encoding="utf-8")


def test_no_row_matches_a_right_answer() -> None:
    """A right answer may raise an exception of its own, print, and build; nothing of it is a known error."""
    patterns = [(row, known_errors.pattern_of(row)) for row in ROWS]
    for answer in answers():
        if answer.diagnoses:
            continue
        said = heard(answer)
        hits = [
            row.means
            for row, pattern in patterns
            for place in row.heard
            if pattern.search(said.get(place, ""))
        ]
        assert not hits, f"{answer.name}: {hits}"


@pytest.mark.parametrize("row", ROWS, ids=lambda row: f"{row.key}: {row.means[:40]}")
def test_the_texts_of_a_row_can_be_filled_in(row: KnownError) -> None:
    names = known_errors.pattern_of(row).groupindex
    words = dict.fromkeys((*names, "here", "owner", "future", "each"), known_errors.Name("x"))
    assert "{" not in row.means.format(**words) + row.do.format(**words).replace("{number}", "").replace(
        "{message.data}", ""
    ).replace("{response.sum}", "").replace("with a }", "").replace("each {", "")


@pytest.mark.parametrize(
    ("command", "says"), cases(__file__, "a_command_that_a_cell_of_bash_does_not_find_is_explained")
)
def test_a_command_that_a_cell_of_bash_does_not_find_is_explained(command: str, says: str) -> None:
    shell = subprocess.run(
        ["bash", "-c", command], env=ros_session._DEFAULTS, capture_output=True, text=True, check=False
    )
    assert shell.returncode == 127
    first, *more = shell.stderr.splitlines()
    assert first == f"bash: {command.split()[0]}: command not found"
    assert says in "".join(more)
    assert bool(more) == bool(says)
