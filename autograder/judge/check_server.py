"""Serves checks: a judge process that has imported everything forks a child for each requested check.

The child exchanges messages with the notebook, from the request to the verdict.

Forking is safe, because the judge process has imported ROS but created no node and no thread. Each check begins with a
new DDS participant, because a new participant discovers the subject at once.
"""

from __future__ import annotations

import contextlib
import hashlib
import secrets
import selectors
import sys
from typing import TYPE_CHECKING, BinaryIO

import msgspec
from msgspec.structs import replace

from autograder import exercises
from autograder.dds_discovery import NoFreeDomainError
from autograder.judge import evidence_files, one_check, reference_recording, ros_setup
from autograder.judge.check_process import Child
from autograder.judge.command_check import SPARE
from autograder.judge.machine_fitness import JudgeFailed
from autograder.judge.notebook_subject import NotebookPath, NotebookSubject
from autograder.judge.path_subject import PathSubject
from autograder.judge.verdicts.deciding import judge
from autograder.judge.verdicts.exercise_faults import WHAT_TO_DO, of_exercise
from autograder.kit.evidence import Evidence
from autograder.messages.json_lines import Hangup, Lines, NotUnderstood, encode, listen
from autograder.messages.judge_messages import Check, Close, Judged, Open, Order, Refused, Report
from autograder.standard_output import private_stdout
from autograder.verdict import not_checked

if TYPE_CHECKING:
    import socket
    from pathlib import Path

    from autograder.judge.one_check import Look
    from autograder.kit.model import Exercise
    from autograder.messages.json_lines import Message


REFUSE_LIMIT = 0.5
"""Seconds to wait for a notebook's request before the notebook is refused."""
CLOSE_LIMIT = 10.0
"""Seconds that a check may still take after its cell has ended. The limit is short, because the kernel usually ends
soon after such a cell, and with the kernel the subject.
"""


class JudgeServer:
    """A judge that listens on a Unix socket. If a grader controls it, it runs only checks that the grader opens."""

    def __init__(self, listener: socket.socket, *, controlled: bool) -> None:
        """Prepare to serve on a listening Unix socket; ``controlled`` says whether a grader sends orders."""
        self._controlled = controlled
        self._order: Open | None = None
        self._child: Child | None = None
        self._children: dict[int, Child] = {}
        self._listener = listener

    def serve(self, control: BinaryIO, answers: BinaryIO) -> None:
        """Serve until ``control`` is closed, that is, at most until the process that started the judge ends."""
        with selectors.DefaultSelector() as selector:
            selector.register(self._listener, selectors.EVENT_READ, self._listener)
            selector.register(control, selectors.EVENT_READ, control)
            answers.write(b"ready\n")
            answers.flush()
            while True:
                for key, _ in selector.select(timeout=1.0):
                    if key.fileobj is self._listener:
                        self._accept()
                    elif not self._obey(control, answers):
                        return
                self._reap()

    def _accept(self) -> None:
        connection, _ = self._listener.accept()
        with connection:
            order = self._order
            if self._controlled and (order is None or self._child is not None):
                _refuse(
                    connection,
                    "no check is expected now: each check cell may request its check once, while it is running",
                )
                return
            limit = max(
                (e.limit for e in exercises.unbroken() if order is None or e.id == order.exercise),
                default=REFUSE_LIMIT,
            )
            child = Child(
                lambda: msgspec.json.encode(_converse(connection, order)),
                limit + SPARE,
                close=[self._listener.fileno()],
            )
            if self._controlled:
                self._child = child
            else:
                self._children[child.pid] = child

    def _obey(self, control: BinaryIO, answers: BinaryIO) -> bool:
        """Read and carry out one order of the grader. Return False if the grader has disconnected."""
        line = control.readline()
        if not line:
            return False
        order = msgspec.json.decode(line, type=Order)
        if isinstance(order, Close):
            answers.write(self._close() + b"\n")
        else:
            self._close()
            self._order = order
            answers.write(b"{}\n")
        answers.flush()
        return True

    def _close(self) -> bytes:
        """End the opened check and return its :class:`Report` as JSON, which only the grader decodes."""
        child, self._child, self._order = self._child, None, None
        if child is None:
            return msgspec.json.encode(Report())
        outcome = child.result(within=CLOSE_LIMIT)
        if outcome.hurried:
            # The cell ended before its check did. In that case the notebook gave up and the judge did not fail, so
            # report no trouble.
            return msgspec.json.encode(Report())
        if outcome.data is None or b"\n" in outcome.data:
            trouble = outcome.trouble or "the judge sent more than one report"
            return msgspec.json.encode(Report(trouble=trouble, unfinished=outcome.unfinished))
        return outcome.data

    def _reap(self) -> None:
        """Remove the children that have ended, so that no zombie is left (if no grader controls this judge)."""
        for pid, child in list(self._children.items()):
            if child.done():
                del self._children[pid]


def _refuse(connection: socket.socket, why: str) -> None:
    """Read a request, then refuse it. If the request stayed unread, closing would lose the refusal (unix(7))."""
    with contextlib.suppress(OSError):
        connection.settimeout(REFUSE_LIMIT)
        connection.recv(65536)
        connection.sendall(encode(Refused(why)))


def run(path: Path) -> None:
    """Serve every notebook that connects, until stdin is closed. Redirect everything printed to stderr."""
    answers = private_stdout()
    sys.stdout = sys.stderr
    try:
        JudgeServer(listen(path), controlled=False).serve(sys.stdin.buffer, answers)
    finally:
        path.unlink(missing_ok=True)


FIRST_WORD = 5.0
"""Time limit in seconds for a notebook's first message, which requests a check."""
MAX_NAME = 100
"""The maximum number of characters of an exercise's name; the rest is ignored."""


def _converse(connection: socket.socket, order: Open | None) -> Report:
    """Read which exercise the notebook asks for, judge it, and send the notebook the verdict.

    Args:
        connection: The socket to the notebook.
        order: The grader's order for the only allowed check; None if the notebook may request any check.

    Returns:
        The report with the verdict; an empty report if no allowed check was requested.
    """
    wanted = order or Open("", secrets.token_hex(8))
    lines = Lines(connection)
    connection.settimeout(FIRST_WORD)
    try:
        first = lines.hear(Check)
    except Hangup:
        return Report()  # the notebook connected and sent nothing
    except NotUnderstood:
        _tell(lines, Refused("the first message must request a check"))
        return Report()
    connection.settimeout(None)
    asked = first.exercise[:MAX_NAME].encode("utf-8", "replace").decode()
    try:
        exercise = exercises.get(asked)
    except exercises.UnknownExercise as error:
        correct = "Correct the name of the exercise in this cell, and run the cell again."
        _tell(lines, Judged(not_checked(asked, asked, 0.0, f"{error}\n{correct}", key="unknown_exercise")))
        return Report()
    except exercises.BrokenExercise as error:
        _tell(lines, Refused(f"{' '.join(str(error).split())}\n{WHAT_TO_DO}"))
        return Report()
    if wanted.exercise and asked != wanted.exercise:
        _tell(lines, Refused(f"the check cell of {wanted.exercise} asked for {asked}"))
        return Report()
    subject: NotebookSubject | PathSubject
    if wanted.workspaces and exercise.runner:
        # Ignore how the notebook describes its subject, because the grader builds and runs the sources.
        subject = PathSubject(lines, exercise.id, wanted.workspaces)
    elif exercise.runner and first.kind == "path":
        subject = NotebookPath(lines)
    else:
        subject = NotebookSubject(lines, is_class=first.kind == "class")
    # If the load of the machine may have spoiled the check, a student gets no verdict. A grader, however, gets a
    # verdict that is marked as crowded, and repeats the check while nothing else runs.
    seed = _own_seed(wanted.seed, exercise.id)
    report, checked = _report(exercise, subject, seed, wanted, marks_crowded=order is not None)
    shown = report.verdict or not_checked(exercise.id, exercise.title, exercise.points, report.trouble)
    _tell(lines, Judged(None if wanted.boxed else shown))
    # The notebook has its verdict and continues while the evidence is packed here.
    if not (wanted.evidence and checked):
        return report
    drawn = checked.evidence.reference if wanted.drawing else None
    return replace(report, evidence=evidence_files.packed(checked, drawn))


def _own_seed(seed: str, exercise_id: str) -> str:
    """Derive the seed of one check. A student sees this seed on the card, but cannot compute other seeds from it."""
    return hashlib.sha256(f"{len(seed)}:{seed}{exercise_id}".encode()).hexdigest()[:16]


def _tell(lines: Lines, message: Message) -> None:
    # If the notebook has disconnected, the verdict is valid nevertheless.
    with contextlib.suppress(Hangup):
        lines.say(message)


def _report(
    exercise: Exercise,
    subject: NotebookSubject | PathSubject,
    seed: str,
    wanted: Open,
    *,
    marks_crowded: bool,
) -> tuple[Report, Look | None]:
    try:
        with ros_setup.lease_domain(alone=wanted.boxed) as domain_id:
            if not wanted.record:
                stored = evidence_files.load_reference(exercise.id, wanted.drawing)
                checked = one_check.check(
                    exercise,
                    subject,
                    stored,
                    seed=seed,
                    domain_id=domain_id,
                    marks_crowded=marks_crowded,
                    practice=evidence_files.load_reference(exercise.id) if wanted.drawing else None,
                )
                return Report(checked.verdict, crowded=checked.crowded), checked
            with of_exercise(exercise):
                if wanted.drawing:
                    recorded = reference_recording.record_drawing(
                        exercise, subject, wanted.drawing, domain_id=domain_id
                    )
                else:
                    recorded = reference_recording.record(exercise, subject, domain_id=domain_id)
                verdict = judge(exercise, Evidence(recorded.parts, recorded), seed)
            return Report(verdict, evidence_files.dump_reference(recorded, exercise.recorded)), None
    except (
        NoFreeDomainError,
        evidence_files.NoReference,
        reference_recording.NotRecordable,
        JudgeFailed,
    ) as error:
        return Report(trouble=str(error)), None
    except Hangup:
        return Report(), None  # the notebook disconnected before it had sent its sources
