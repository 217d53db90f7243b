"""A class in which every student but two is an attacker, graded in one batch, with traps laid around it."""

from __future__ import annotations

import contextlib
import csv
import hashlib
import inspect
import os
import re
import secrets
import socket
import subprocess
import sys
import threading
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Self

import nbformat
import ordinary_user
import planting
from attack_bank import HERE, USUAL, Attack

from autograder import course
from autograder.grading.new_classes.new_class import new_class
from autograder.kit import reported_texts

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence
    from pathlib import Path

    from planting import Planted

CELL_SECONDS = 8.0
NOTEBOOK_SECONDS = 100.0
LIMITS = {"memory_bytes": 800_000_000, "scratch_bytes": 200_000_000, "processes": 200, "cpu_seconds": 60}
"""Small, so that filling them takes seconds."""
GRADING_LIMIT = 3600.0
"""Seconds after which the batch is taken to hang. Four minutes are usual, a quarter of an hour at a load of sixty."""
_CORES = os.cpu_count() or 1
MARK = "attack_canary"
"""In the name of every file and process that an attack leaves behind."""
HONEST = {
    "honest_ada": {"lab_1_2.talker": 10.0, "lab_1_2.listener": 10.0},
    # The talker keeps another rate: three points of ten.
    "honest_ben": {"lab_1_2.talker": 7.0, "lab_1_2.listener": 10.0},
}
"""The students who attack nobody, and what they have earned."""


class Traps:
    """Services and files around the class that no submission may reach."""

    def __init__(self, folder: Path) -> None:
        self.home = folder / "home"
        (self.home / ".ssh").mkdir(parents=True)
        self.secrets = {
            "environment": "canary-of-the-environment-91ab37",
            "home": "canary-of-the-home-folder-c20d44",
            "neighbour": "canary-of-the-neighbour-b7731e",
            "solution": "canary-of-the-solution-5e1f0c",
            "entry points": "canary.of_the:entry_points_04d1",
        }
        (self.home / ".ssh" / "id_rsa").write_text(self.secrets["home"])
        (self.home / "entry_points.txt").write_text(f"simple_node = {self.secrets['entry points']}\n")
        os.mkfifo(self.home / "pipe")
        self.visitors: list[str] = []
        self._open = contextlib.ExitStack()
        self.tcp_port = self._listen(socket.socket(), ("127.0.0.1", 0))
        self.mark = f"{MARK}_{secrets.token_hex(4)}"
        """In the command line of what an attack starts and in what it sends: of this run alone."""
        self.abstract = f"{self.mark}_abstract"
        self._listen(socket.socket(socket.AF_UNIX), f"\0{self.abstract}")
        self._udp = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._udp.bind(("127.0.0.1", 0))
        self.udp_port = int(self._udp.getsockname()[1])
        self._open.callback(self._udp.close)
        self.planted: Mapping[str, str] = {}

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._open.close()

    def plant(self, words: Mapping[str, str]) -> Planted:
        """Plant secrets around the class, which disappear with these traps."""
        planted = planting.plant(words, self._open)
        self.planted = planted.secrets
        return planted

    def datagrams(self) -> list[bytes]:
        """What has arrived by UDP."""
        found = []
        self._udp.setblocking(False)
        with contextlib.suppress(BlockingIOError):
            while True:
                found.append(self._udp.recv(1000))
        return found

    def _listen(self, listener: socket.socket, address: Any) -> int:
        listener.bind(address)
        listener.listen(16)
        self._open.callback(listener.close)

        def serve() -> None:
            with contextlib.suppress(OSError):
                while True:
                    connection, _ = listener.accept()
                    with connection:
                        connection.settimeout(2.0)
                        self.visitors.append(connection.recv(100).decode(errors="replace"))

        threading.Thread(target=serve, daemon=True).start()
        name = listener.getsockname()
        return int(name[1]) if isinstance(name, tuple) else 0


@dataclass(frozen=True)
class Graded:
    """What came of the batch.

    Attributes:
        path: The class.
        exit_code: Of ``autograder grade``.
        output: What it printed.
        seconds: Wall time.
        rows: Points, state and diagnosis by student and exercise, as `grades.csv` has them.
        before: Digests of everything that nobody may change, before the batch.
        after: The same, afterwards.
    """

    path: Path
    exit_code: int
    output: str
    seconds: float
    rows: dict[str, dict[str, dict[str, str]]]
    before: dict[str, str] = field(default_factory=dict)
    after: dict[str, str] = field(default_factory=dict)

    def points(self, student: str) -> dict[str, float]:
        """What a student got, by exercise; nothing for what was not handed in or could not be checked."""
        rows = self.rows.get(student, {})
        return {
            name: float(row["score"])
            for name, row in rows.items()
            if row["state"] != "not_submitted" and row["score"]
        }

    def written_about(self, student: str) -> str:
        """All that the grader wrote down about a student."""
        files = [f for step in ("autograded", "feedback") for f in (self.path / step / student).rglob("*")]
        return "\n".join(f.read_text(errors="replace") for f in sorted(files) if f.is_file())

    def everything_made(self) -> Iterator[bytes]:
        """What the batch has made, about anybody: pages, tables, the gradebook, results and evidence."""
        tops = [self.path / name for name in ("autograded", "feedback", "export", "grades.csv")]
        stores = [self.path / "gradebook.db", self.path / ".autograder" / "class.db"]
        for path in (*tops, *stores):
            for file in sorted(path.rglob("*")) if path.is_dir() else [path]:
                if file.is_file():
                    yield from planting.everything_in(file)


def _listeners_texts() -> str:
    """Python that draws the texts which the judge sends to a listener: the course is public, its boxes are not."""
    known = ("SINGLY", "AT_PACE", "TRIES", "_UNUSUAL", "GREETING", "_WORDS", "_ELSEWHERE")
    lines = [f"{name} = {getattr(reported_texts, name)!r}" for name in known]
    return "\n".join(["from random import Random", *lines, inspect.getsource(reported_texts.random_texts)])


class AttackClass:
    """Makes the class, hands everything in and grades it.

    Args:
        folder: An empty folder.
        traps: What lies around it.
        as_user: Let somebody without any right of root's grade it, with the number of open files that a login has.
    """

    def __init__(self, folder: Path, traps: Traps, *, as_user: bool = False) -> None:
        self.path = folder / "class"
        self._traps = traps
        self._as_user = as_user
        new_class(self.path, HERE / "course", cell_seconds=CELL_SECONDS, notebook_seconds=NOTEBOOK_SECONDS)
        with (self.path / "nbgrader_config.py").open("a") as config:
            config.writelines(f"c.WireExecute.{name} = {value}\n" for name, value in LIMITS.items())
        self._words = {
            "<<class>>": str(self.path),
            "<<home>>": str(traps.home),
            "<<repository>>": str(course.root()),
            "<<environment>>": sys.prefix,
            "<<tcp_port>>": str(traps.tcp_port),
            "<<udp_port>>": str(traps.udp_port),
            "<<abstract>>": traps.abstract,
            "<<mark>>": traps.mark,
            "<<listeners_texts>>": _listeners_texts(),
            "<<random>>": secrets.token_hex(4),
            "<<reference>>": str(next(course.root().glob("solutions/*/lab_1_2/talker.reference.json"))),
        }
        self._planted = traps.plant(self._words)
        self._words["<<planted>>"] = repr([str(path) for path in self._planted.paths])
        self._hand_in_honest_work()

    def hand_in(self, attack: Attack) -> None:
        """Hand in an attack."""
        notebook = self._released(attack.assignment)
        folder = self.path / "submitted" / attack.name / attack.assignment
        folder.mkdir(parents=True)
        if attack.is_program:
            attack.program().hand_in(folder, notebook)
        else:
            self._fill(notebook, attack.assignment, self._known(attack.cells()))
            nbformat.write(notebook, folder / f"{attack.assignment}.ipynb")
        self._give(folder)

    def grade(self, *options: str) -> Graded:
        """Run ``autograder grade`` as an instructor does, in a process of its own."""
        self._give(self.path.parent)
        before = self._digests()
        began = os.times().elapsed
        done = subprocess.run(
            # Attackers mostly wait, for a limit or for a second look: two at once keep a processor busy.
            [
                *([sys.executable, ordinary_user.__file__] if self._as_user else []),
                sys.executable,
                "-m",
                "autograder",
                "grade",
                str(self.path),
                "--jobs",
                str(2 * _CORES),
                *options,
            ],
            env={
                **os.environ,
                **self._planted.variables,
                **planting.overlay_of(self._traps.home),
                "HOME": str(self._traps.home),
                "ATTACK_CANARY": self._traps.secrets["environment"],
            },
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            timeout=GRADING_LIMIT,
            check=False,
        )
        return Graded(
            path=self.path,
            exit_code=done.returncode,
            output=done.stdout.decode(errors="replace"),
            seconds=os.times().elapsed - began,
            rows=self._rows(),
            before=before,
            after=self._digests(),
        )

    def _hand_in_honest_work(self) -> None:
        right = [("right", "TalkerNode", ""), ("right", "ListenerNode", "")]
        partly = (
            "solution",
            "TalkerNode",
            self._right(USUAL, "TalkerNode").replace("0.5, self", "1.0, self"),
        )
        secret = ("extra", "", f'"""{self._traps.secrets["neighbour"]}"""')
        for student, cells in zip(HONEST, (right, [partly, right[1]]), strict=True):
            notebook = self._released(USUAL)
            self._fill(notebook, USUAL, [secret, *cells])
            folder = self.path / "submitted" / student / USUAL
            folder.mkdir(parents=True)
            nbformat.write(notebook, folder / f"{USUAL}.ipynb")
            self._give(folder)

    def _give(self, folder: Path) -> None:
        """Let the grader own a folder and what is in it. At once: who was first is told from times of change."""
        if self._as_user:
            for place in (folder, *folder.rglob("*")):
                if place.lstat().st_uid != ordinary_user.USER:
                    os.chown(place, ordinary_user.USER, ordinary_user.USER, follow_symlinks=False)

    def _released(self, assignment: str) -> Any:
        return nbformat.read(self.path / "release" / assignment / f"{assignment}.ipynb", as_version=4)

    def _right(self, assignment: str, name: str) -> str:
        source = nbformat.read(self.path / "source" / assignment / f"{assignment}.ipynb", as_version=4)
        cell = next(c for c in source.cells if c.metadata.get("nbgrader", {}).get("grade_id") == name)
        lines = [line.partition("  # canary-of")[0] for line in cell.source.split("\n")]
        return "\n".join(line for line in lines if not line.strip().startswith("### "))

    def _fill(self, notebook: Any, assignment: str, cells: Iterable[tuple[str, str, str]]) -> None:
        """Put an attack's cells into the released notebook."""
        waiting: list[Any] = []
        for kind, name, source in cells:
            if kind == "extra":
                waiting.append(nbformat.v4.new_code_cell(source))
                continue
            place = next(
                i
                for i, c in enumerate(notebook.cells)
                if c.metadata.get("nbgrader", {}).get("grade_id") == name
            )
            if kind == "behind":
                notebook.cells.insert(place + 1, nbformat.v4.new_code_cell(source))
                continue
            notebook.cells[place].source = self._right(assignment, name) if kind == "right" else source
            notebook.cells[place:place] = waiting
            waiting = []
        notebook.cells += waiting

    def _known(self, cells: Sequence[tuple[str, str, str]]) -> Iterator[tuple[str, str, str]]:
        """Fill in what an attacker who knows the grader's machine would know."""
        # First, because there are words of the others in them.
        words = {**{f"<<{part.stem}>>": part.read_text() for part in HERE.glob("parts/*.py")}, **self._words}
        for kind, name, source in cells:
            for word, meaning in words.items():
                source = source.replace(word, meaning)
            # An attack with a word that nobody fills in would be a syntax error, and count as defeated.
            assert not (unknown := re.findall(r"<<\w+>>", source)), unknown
            yield kind, name, source

    def _rows(self) -> dict[str, dict[str, dict[str, str]]]:
        found: dict[str, dict[str, dict[str, str]]] = {}
        with (
            contextlib.suppress(FileNotFoundError),
            (self.path / "grades.csv").open(newline="", encoding="utf-8-sig") as file,
        ):
            for row in csv.DictReader(file):
                found.setdefault(row["student"], {})[row["exercise"]] = row
        return found

    def _digests(self) -> dict[str, str]:
        """Of what no submission may change: sources, submissions, the secret, the home folder, the solutions."""
        folders = [
            *(self.path / name for name in ("source", "release", "submitted", "nbgrader_config.py")),
            self.path / ".autograder" / "secret",
            self._traps.home,
            course.root() / "solutions",
        ]
        files = (
            f for folder in folders for f in ([folder] if folder.is_file() else sorted(folder.rglob("*")))
        )
        return {
            str(file): hashlib.sha256(file.read_bytes()).hexdigest()
            for file in files
            if file.is_file() and not file.is_symlink() and "__pycache__" not in file.parts
            # The grader keeps builds under the names of their keys.
            if not any(re.fullmatch(r"[0-9a-f]{64}(\.\w+)?", part) for part in file.parts)
        }
