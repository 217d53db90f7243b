"""``collect`` and ``grade`` ended by TERM and KILL: nothing is lost, and the same command goes on.

Of a power cut the same holds as far as each step is on the disk before the next one, which the last tests look at.
"""

from __future__ import annotations

import os
import random
import re
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest
from click.testing import CliRunner
from downloads import write_zip
from test_collect import work

from autograder.boxes.sandbox import why_impossible
from autograder.cli import cli
from autograder.grading.classes.class_directory import ClassDirectory
from autograder.grading.collecting.collect import collect
from autograder.grading.collecting.collected_csv import Table
from autograder.grading.collecting.collected_files import CollectedRecords, Inbox
from autograder.safe_files import write_whole

if TYPE_CHECKING:
    from collections.abc import Callable

    from tiny_class import TinyClass

STUDENTS = [f"s{place:02}" for place in range(24)]
FEW, MANY = 3, 20
"""Moments: in the short tier, and in the nightly one."""
PATIENCE = 120.0
KILL_THE_GRADER = Path(__file__).parents[1] / "kill_the_grader.py"


def start(klass: Path, *words: str) -> subprocess.Popen[str]:
    command = [sys.executable, "-W", "ignore", "-m", "autograder", words[0], str(klass), *words[1:]]
    return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)


def run(klass: Path, *words: str) -> int:
    process = start(klass, *words)
    process.communicate()
    return process.returncode


def end_in_its_middle(
    klass: Path, words: tuple[str, ...], has_come_to: Callable[[], bool], chance: random.Random, with_: int
) -> bool:
    """Start a command and send it a signal a moment after it has come to something; whether that ended it."""
    process = start(klass, *words)
    deadline = time.monotonic() + PATIENCE
    while process.poll() is None and not has_come_to():
        assert time.monotonic() < deadline
        time.sleep(0.0005)
    time.sleep(chance.uniform(0, 0.01))
    process.send_signal(with_)
    process.communicate()
    return process.returncode == -with_


def files_below(folder: Path) -> dict[str, bytes]:
    return {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def collected(klass: Path) -> tuple[object, ...]:
    """All that collecting leaves behind, without the times of collecting itself."""
    directory = ClassDirectory(klass)
    records = CollectedRecords(directory.state)
    histories = {}
    for student in STUDENTS:
        history = records.get("lab_1_2", student)
        assert history is not None
        histories[student] = [(one.content, one.when) for one in history.now.values()]
    kept = sorted(Inbox(directory.state).deliveries)
    waiting = sorted(one.label for one in Table(directory).waiting())
    return files_below(klass / "submitted"), histories, kept, waiting, Table(directory).lines()


@pytest.mark.slow
@pytest.mark.parametrize("moments", [FEW, MANY])
def test_collect_is_ended_and_goes_on(tiny: TinyClass, tmp_path: Path, moments: int) -> None:
    """Later work of everybody in place of earlier work, and a file of nobody's."""
    seed = random.SystemRandom().randrange(1 << 30)
    chance = random.Random(seed)
    print(f"seed {seed}")
    (tiny.path / "students.csv").write_text("id\n" + "\n".join(STUDENTS), encoding="utf-8")
    texts = {(one, day): work(tiny, place, day) for place, one in enumerate(STUDENTS) for day in (3, 4)}
    archives = {
        day: write_zip(
            tmp_path / f"{day}.zip",
            {f"Lab_{one}_attempt_2025-10-0{day}-14-00-00_lab_1_2.ipynb": texts[one, day] for one in STUDENTS}
            | {f"guest_{day}.ipynb": texts["s00", day]},
        )
        for day in (3, 4)
    }
    collect(tiny.path, [archives[3]])
    words = ("collect", str(archives[4]))
    whole = shutil.copytree(tiny.path, tmp_path / "whole")
    assert run(whole, *words) == 2
    wanted = collected(whole)
    in_time = 0
    for moment in range(moments):
        klass = shutil.copytree(tiny.path, tmp_path / f"{moment}")
        place = klass / "submitted" / chance.choice(STUDENTS[:16]) / "lab_1_2" / "lab_1_2.ipynb"
        with_ = (signal.SIGTERM, signal.SIGKILL)[moment % 2]
        in_time += end_in_its_middle(klass, words, replaced(place), chance, with_)
        check_that_none_is_lost(klass, texts)
        # Not in another process, of which each takes two seconds to start: all that is known is in the class.
        assert CliRunner().invoke(cli, [words[0], str(klass), *words[1:]]).exit_code == 2
        assert collected(klass) == wanted
        assert not [*klass.rglob("*.new")], "something half written is left"
        shutil.rmtree(klass)
    print(f"{in_time} of {moments} were ended in their middle")
    assert in_time, "no signal came in time"


def replaced(place: Path) -> Callable[[], bool]:
    """Whether a file is another one than it was."""
    before = place.stat().st_ino
    return lambda: place.stat().st_ino != before


def check_that_none_is_lost(klass: Path, texts: dict[tuple[str, int], str]) -> None:
    inbox = Inbox(klass / ".autograder")
    contents = {one.content for of in inbox.deliveries.values() for one in of.arrivals}
    kept = {inbox.read(content).decode() for content in contents}
    for one in STUDENTS:
        there = (klass / "submitted" / one / "lab_1_2" / "lab_1_2.ipynb").read_text()
        assert there in (texts[one, 3], texts[one, 4]), f"half of {one}'s is there"
        assert there == texts[one, 3] or texts[one, 3] in kept, f"{one}'s is lost"


@pytest.mark.slow
@pytest.mark.parametrize("moments", [MANY])
def test_grade_is_ended_and_goes_on(moments: int) -> None:
    """In a process that adopts whatever the grader leaves: see ``kill_the_grader.py``."""
    if reason := why_impossible():
        pytest.skip(reason)
    ended = subprocess.run(
        [sys.executable, "-W", "ignore", str(KILL_THE_GRADER), "--kills", str(moments)],
        capture_output=True,
        text=True,
        check=False,
    )
    assert ended.returncode == 0, ended.stdout + ended.stderr
    assert ended.stdout.count("killed after") == moments


# -- a power cut
# ------------------------------------------------------------------------------------------------------


def test_a_file_is_on_the_disk_before_it_has_its_name_and_its_name_before_anything_else(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    done: list[str] = []
    real_sync, real_replace = os.fsync, Path.replace

    def sync(descriptor: int) -> None:
        done.append(f"sync {os.path.basename(os.readlink(f'/proc/self/fd/{descriptor}'))}")  # noqa: PTH115, PTH119
        real_sync(descriptor)

    def replace(path: Path, to: Path) -> Path:
        done.append(f"name {to.name}")
        return real_replace(path, to)

    monkeypatch.setattr(os, "fsync", sync)
    monkeypatch.setattr(Path, "replace", replace)
    write_whole(tmp_path / "new" / "deep" / "file", b"all of it")
    assert re.fullmatch(r"sync \.file\.\d+\.new", done[0])  # a name that nobody can guess
    assert done[1:] == ["name file", "sync deep", "sync new", f"sync {tmp_path.name}"]


def written_by(folder: Path, *words: str) -> set[str]:
    """The files in a folder that a command opens to write: it runs in a child, whose hook nobody can take away."""
    heard, said = os.pipe()
    if (child := os.fork()) == 0:

        def watch(event: str, arguments: tuple[Any, ...]) -> None:
            if event == "open" and isinstance(arguments[0], str | bytes | os.PathLike):
                name = os.fsdecode(arguments[0])
                if name.startswith(str(folder)) and arguments[2] & (os.O_WRONLY | os.O_RDWR):
                    os.write(said, f"{name}\n".encode())

        sys.addaudithook(watch)
        CliRunner().invoke(cli, words)
        os._exit(0)
    os.close(said)
    with os.fdopen(heard) as names:
        found = set(names.read().splitlines())
    os.waitpid(child, 0)
    return found


def test_whatever_collect_and_export_write_is_written_so(tiny: TinyClass, tmp_path: Path) -> None:
    (tiny.path / "students.csv").write_text("id\nada\n", encoding="utf-8")
    files = {"Lab_ada_attempt_2025-10-03-14-00-00_lab_1_2.ipynb": work(tiny), "guest.ipynb": work(tiny)}
    archive = write_zip(tmp_path / "c.zip", files)
    for words in (("collect", str(tiny.path), str(archive)), ("export", str(tiny.path), "--to", "csv")):
        written = written_by(tiny.path, *words)
        # A file without a name, which is gone with its process, is opened by the name of its folder.
        others = {
            path for path in written if not path.endswith((".new", "/lock")) and not Path(path).is_dir()
        }
        assert written - others
        assert not others
