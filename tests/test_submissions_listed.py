"""The bank of answers is whole: every program is listed, is there, and has a diagnosis that is explained.

This looks at the data alone; the judging of the bank has a test of its own.
"""

from __future__ import annotations

import re
import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from autograder import exercises, known_errors
from autograder.authoring.answer_bank import answers, answers_folder
from autograder.authoring.answer_tables import ANSWER_KINDS
from autograder.kit.oracle.naming import mutant_words

ROOT = Path(__file__).parents[1]
NOTEBOOKS = Path(__file__).parent / "submissions" / "notebooks"
MISTAKES = ROOT / "docs" / "mistakes.md"
"""Written by hand: its sections, tables and order are for readers, and a key may have several recognizers."""
FOLDERS = [answers_folder(exercise_id) for exercise_id in exercises.all_ids()]
CELL = re.compile(r"^# %% (solution \w+|extra)$", re.MULTILINE)
PROGRAMS = list(answers())


@dataclass(frozen=True)
class InNotebook:
    """An answer that students write into a notebook: its file, and what its listing says."""

    path: Path
    entry: dict[str, Any]

    @property
    def kind(self) -> str:
        return self.path.parent.name

    @property
    def source(self) -> str:
        return self.path.read_text(encoding="utf-8")

    @property
    def keys(self) -> set[str]:
        """All diagnoses that are right for it."""
        return {self.entry["diagnosis"], *self.entry.get("also", [])} if "diagnosis" in self.entry else set()


IN_NOTEBOOKS = [
    InNotebook(NOTEBOOKS / exercise / kind / name, entry)
    for exercise, listing in tomllib.loads((NOTEBOOKS / "notebooks.toml").read_text(encoding="utf-8")).items()
    for kind in ANSWER_KINDS
    for name, entry in listing[kind].items()
]


def is_python(source: str) -> bool:
    try:
        compile(source, "an answer", "exec", dont_inherit=True)
    except SyntaxError:
        return False
    return True


def explained() -> set[str]:
    headings = re.findall(r"^### .+$", MISTAKES.read_text(encoding="utf-8"), re.MULTILINE)
    return set(re.findall(r"`(\w+)`", " ".join(headings)))


def test_every_file_is_listed_and_every_listed_one_is_there() -> None:
    files = [path for folder in (NOTEBOOKS, *FOLDERS) for path in folder.rglob("*.*") if path.is_file()]
    found = {path for path in files if path.parent.name in ANSWER_KINDS and path.suffix != ".toml"}
    whole = {answer.file for answer in PROGRAMS if answer.edit is None}
    assert found == whole | {answer.path for answer in IN_NOTEBOOKS}


def test_every_edit_fits_its_base_and_no_two_answers_are_the_same(tmp_path: Path) -> None:
    # Reading an edit raises where it does not fit, and so does making a workspace.
    assert len({(answer.exercise, answer.text) for answer in PROGRAMS}) == len(PROGRAMS)
    for number, answer in enumerate(answer for answer in PROGRAMS if answer.base is not None):
        folder = tmp_path / str(number)
        folder.mkdir()
        answer.unpack(folder)


def test_a_program_says_in_its_first_line_what_it_shows() -> None:
    mute = [
        a.name
        for a in PROGRAMS
        if not a.text.lstrip("<!-# \"'").startswith("Wrong" if a.diagnoses else "Right")
    ]
    assert mute == []


def test_only_a_syntax_error_cannot_be_read_by_python() -> None:
    programs = [answer for answer in PROGRAMS if answer.file.suffix == ".py"]
    unreadable = {answer.name for answer in programs if not is_python(answer.text)}
    assert unreadable == {a.name for a in programs if a.diagnoses and a.diagnoses[0] == "syntax_error"}


def test_what_fails_has_a_diagnosis_and_what_passes_has_none() -> None:
    assert [a.name for a in PROGRAMS if bool(a.diagnoses) != (a.file.parent.name == "wrong")] == []
    assert [a.path for a in IN_NOTEBOOKS if bool(a.keys) != (a.entry["verdict"] == "failed")] == []


def test_every_diagnosis_is_explained_to_students() -> None:
    used = {key for answer in PROGRAMS for key in answer.diagnoses}
    used |= {key for answer in IN_NOTEBOOKS for key in answer.keys}
    used |= {mistake.key for one in exercises.all_ids() for mistake in exercises.get(one).mistakes}
    # A recorded wrong answer says on the card itself what it is.
    recorded = {
        "variant",
        "mutant",
        *(key for answer in PROGRAMS if answer.advice for key in answer.diagnoses),
    }
    assert used - recorded - explained() == set()


def test_every_explained_diagnosis_is_one_that_a_card_can_have() -> None:
    files = [*(ROOT / "autograder").rglob("*.py"), *(ROOT / "solutions").glob("*/*/*.py")]
    key = re.compile(r'(?:"|^def )(\w+)(?:"|\()', re.MULTILINE)
    written = {found for file in files for found in key.findall(file.read_text(encoding="utf-8"))}
    written |= {row.key for row in known_errors.rows()} | {row.key for row in mutant_words.TABLE}
    assert explained() - written == set()


def test_a_wrong_program_is_named_after_its_diagnosis() -> None:
    wrong = [a for a in PROGRAMS if a.diagnoses]
    assert [a.name for a in wrong if not a.file.name.startswith(a.diagnoses[0])] == []


def test_an_answer_in_a_notebook_names_its_exercise_and_its_cells() -> None:
    for answer in IN_NOTEBOOKS:
        assert answer.source.startswith(f"# {answer.path.parent.parent.name}: "), answer.path
        assert any(cell.startswith("solution") for cell in CELL.findall(answer.source)), answer.path
        assert (answer.entry["verdict"] == "passed") == (answer.kind == "right"), answer.path
