"""What a term brings: groups, attempts, corrections by hand, a class of an older version, kills and full disks."""

from __future__ import annotations

import csv
import ctypes
import errno
import io
import os
import random
import shutil
import sys
import traceback
from pathlib import Path
from typing import TYPE_CHECKING, NoReturn

import pytest
from click.testing import CliRunner
from downloads import write_zip
from test_collect import lies, placed, work
from test_collected_csv import edit, read, save
from test_where_it_goes import outcome
from tiny_class import LISTENER, TALKER

from autograder.boxes.process_isolation import leave_the_host, mount_tmpfs
from autograder.boxes.sandbox import why_impossible
from autograder.cli import cli
from autograder.grading.classes.class_directory import ClassDirectory
from autograder.grading.collecting import collected_csv, collected_files, submitted_folder
from autograder.grading.collecting.collect import collect
from autograder.grading.collecting.collected_files import LineState
from autograder.grading.grading_errors import ClassBusy, GradingError

if TYPE_CHECKING:
    from collections.abc import Callable
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


def test_a_disk_that_really_fills_up_loses_nothing(klass: TinyClass, tmp_path: Path) -> None:
    """What a box unpacks, and the inbox, do not fit on a disk of 6 MB; what was collected before is still there."""
    if reason := why_impossible():
        pytest.skip(reason)
    small = blackboard(klass, tmp_path, ada=(3, 1))
    large = write_zip(
        tmp_path / "large.zip",
        {f"{DAY.format('ben', 4)[:-6]} {n}.txt": random.Random(n).randbytes(3_000_000) for n in range(4)},
    )
    disk = tmp_path / "disk"
    disk.mkdir()

    def work_there() -> None:
        mount_tmpfs(disk, 6_000_000, 10_000)
        copy = type(klass)(Path(shutil.copytree(klass.path, disk / "class")))
        collect(copy.path, [small])
        before = outcome(copy)
        with pytest.raises(GradingError, match="is full"):
            collect(copy.path, [large])
        assert not [*copy.path.rglob("*.new")]
        assert collect(copy.path, [small]).exit_code == 0
        assert outcome(copy) == before

    away_from_the_host(work_there)


def away_from_the_host(call: Callable[[], None]) -> None:
    """Call a function in a child process whose mounts no other process sees."""
    if (child := os.fork()) == 0:
        code = 1
        try:
            leave_the_host()
            call()
            code = 0
        except BaseException:
            traceback.print_exc()
        finally:
            os._exit(code)
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0


def test_a_class_on_a_disk_that_is_only_read_is_one_sentence(klass: TinyClass, tmp_path: Path) -> None:
    if reason := why_impossible():
        pytest.skip(reason)
    archive = blackboard(klass, tmp_path, ada=(3, 1))
    (disk := tmp_path / "disk").mkdir()

    def work_there() -> None:
        mount_tmpfs(disk, 6_000_000, 10_000)
        copy = Path(shutil.copytree(klass.path, disk / "class"))
        read_only = ctypes.c_ulong(0x20 | 0x2 | 0x4 | 0x1)  # remounted without setuid, devices and writing
        assert ctypes.CDLL(None, use_errno=True).mount(None, os.fsencode(disk), None, read_only, None) == 0
        result = CliRunner().invoke(cli, ["collect", str(copy), str(archive)])
        assert result.exit_code == 2, result.output
        assert "Read-only file system" in result.output
        assert "Traceback" not in result.output

    away_from_the_host(work_there)


def killed_at(klass: Path, archive: Path, moment: int) -> int:
    """Collect in a child that ends without a word when it opens, renames or removes its file of this number.

    Returns:
        How many such moments came; the child ended at the last one if that is ``moment``.
    """
    read_end, write_end = os.pipe()
    if (child := os.fork()) == 0:
        came = 0

        def watch(event: str, arguments: tuple[object, ...]) -> None:
            nonlocal came
            if event in ("open", "os.rename", "os.remove") and str(klass) in str(arguments[0]):
                came += 1
                if came == moment:
                    os.write(write_end, str(came).encode())
                    os._exit(9)

        sys.addaudithook(watch)
        try:
            collect(klass, [archive])
        finally:
            os.write(write_end, str(came).encode())
            os._exit(0)
    os.close(write_end)
    os.waitpid(child, 0)
    with os.fdopen(read_end) as pipe:
        return int(pipe.read())


def test_killed_at_ten_random_moments_nothing_is_lost(klass: TinyClass, tmp_path: Path) -> None:
    seed = random.SystemRandom().randrange(1 << 30)
    print(f"seed {seed}")
    collect(klass.path, [blackboard(klass, tmp_path, ada=(3, 1), ben=(3, 2))])
    edit(klass, "ben", use="yes")
    later = blackboard(klass, tmp_path, ada=(4, 3), ben=(4, 4), eve=(4, 5))

    def fresh(name: str) -> TinyClass:
        return type(klass)(Path(shutil.copytree(klass.path, tmp_path / name)))

    whole = fresh("whole")
    moments = killed_at(whole.path, later, 0)
    assert moments > 20
    for number, moment in enumerate(random.Random(seed).sample(range(1, moments + 1), 10)):
        copy = fresh(f"copy{number}")
        assert killed_at(copy.path, later, moment) == moment
        assert lies(copy, "ben") == work(klass, 2)
        report = collect(copy.path, [later])
        assert not report.having(LineState.NOT_PLACED)
        assert outcome(copy) == outcome(whole), f"killed at {moment}"
        assert not [*copy.path.rglob("*.new")]
