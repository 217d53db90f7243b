"""What a term brings: groups, attempts, corrections by hand, a class of an older version, kills and full disks."""

from __future__ import annotations

import csv
import errno
import io
from typing import TYPE_CHECKING, NoReturn

import pytest
from downloads import write_zip
from test_collect import lies, placed, work
from test_collected_csv import edit, read, save
from test_where_it_goes import outcome
from tiny_class import LISTENER, TALKER

from autograder.grading.classes.class_directory import ClassDirectory
from autograder.grading.collecting import collected_csv, collected_files, submitted_folder
from autograder.grading.collecting.collect import collect
from autograder.grading.grading_errors import ClassBusy, GradingError

if TYPE_CHECKING:
    from pathlib import Path
    from types import ModuleType

    from tiny_class import FakeEngine, TinyClass

DAY = "Lab_{}_attempt_2025-10-0{}-14-00-00_lab_1_2.ipynb"


def blackboard(klass: TinyClass, folder: Path, **attempts: tuple[int, int]) -> Path:
    """A download with one attempt of each student, of a day and with points."""
    files = {DAY.format(student, day): work(klass, points) for student, (day, points) in attempts.items()}
    return write_zip(folder / "blackboard.zip", files)


def counting(klass: TinyClass) -> dict[str, str]:
    return {line["file"].partition(" #")[0]: line["counts"] for line in read(klass)[1]}


def test_work_that_comes_after_grading_is_graded_again_and_the_first_one_is_kept(
    klass: TinyClass, tmp_path: Path, fake_engine: FakeEngine
) -> None:
    for day, points in ((1, 3), (2, 8)):
        collect(klass.path, [blackboard(klass, tmp_path, ada=(day, points), ben=(1, 4))])
        klass.grade()
        assert klass.scores("ada") == {TALKER: points, LISTENER: 10}
    assert fake_engine.ran == ["ada", "ben", "ada"]
    assert sorted(counting(klass).values()) == ["earlier", "yes", "yes"]
    edit(klass, DAY.format("ada", 2), use="no")
    collect(klass.path)
    klass.grade()
    assert klass.scores("ada")[TALKER] == 3


def test_a_class_that_never_typed_collect_has_no_table(klass: TinyClass, fake_engine: FakeEngine) -> None:
    klass.submit("ada", 4)
    report = klass.grade()
    assert (report.exit_code, klass.scores("ada")[TALKER]) == (0, 4)
    assert not (klass.path / "collected.csv").exists()
    assert not (klass.path / ".autograder" / "inbox").exists()


@pytest.mark.parametrize("separator", [",", ";", "\t"])
@pytest.mark.parametrize("letters", ["utf-8", "utf-8-sig", "utf-16"])
def test_no_cell_runs_and_a_spreadsheet_changes_nothing_by_saving(
    klass: TinyClass, tmp_path: Path, separator: str, letters: str
) -> None:
    names = [
        "=HYPERLINK(1).ipynb",
        "@SUM(A1).ipynb",
        "+1-2.ipynb",
        "-2+3.ipynb",
        "\t=1.ipynb",
        "März 3.ipynb",
    ]
    files = {f"007/{name}": work(klass, place) for place, name in enumerate(names)}
    # The name in the system is a cell of its own, and its number must stay a text.
    called = ("=1+1", "@SUM(A1)", "+1-2", "-2+3", "März 3", "true")
    files |= {f"{name}_0031_assignsubmission_file_lab_1_2.ipynb": work(klass) for name in called}
    collect(klass.path, [write_zip(tmp_path / "f.zip", files)])
    text = (klass.path / "collected.csv").read_text(encoding="utf-8-sig")
    for line in csv.reader(io.StringIO(text)):
        assert not [cell for cell in line if cell[:1] in tuple("=+-@\t\r")]
        assert not {"0031", "März 3", "true"} & set(line)
    before = outcome(klass)
    save(klass, *read(klass), separator, letters)
    report = collect(klass.path)
    assert report.notes == ()
    assert outcome(klass) == before


def test_two_instructors_at_once_are_told_so(klass: TinyClass, tmp_path: Path) -> None:
    archive = blackboard(klass, tmp_path, ada=(3, 1))
    with ClassDirectory(klass.path).lock(), pytest.raises(ClassBusy, match="is grading"):
        collect(klass.path, [archive])
    assert placed(collect(klass.path, [archive])).keys() == {"ada"}


@pytest.mark.parametrize(
    ("module", "name"),
    [(collected_files, "keep_whole"), (submitted_folder, "write_whole"), (collected_csv, "write_whole")],
)
def test_a_full_disk_has_a_sentence_and_the_same_command_goes_on(
    klass: TinyClass, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, module: ModuleType, name: str
) -> None:
    archive = blackboard(klass, tmp_path, ada=(3, 1), ben=(3, 2))

    def full(*_: object) -> NoReturn:
        raise OSError(errno.ENOSPC, "No space left on device")

    with monkeypatch.context() as patch:
        patch.setattr(module, name, full)
        with pytest.raises(GradingError, match="is full"):
            collect(klass.path, [archive])
    assert not [*klass.path.rglob("*.new")]
    assert collect(klass.path, [archive]).exit_code == 0
    assert (lies(klass, "ada"), lies(klass, "ben")) == (work(klass, 1), work(klass, 2))
