"""``python -m benchmarks.check_times [EXERCISE ...]``: how long a student waits for the card of each check.

Each answer is checked in a kernel of its own, as in JupyterLab, by a judge that is ready. Seconds count from the check
cell until a message with a card comes. A check that builds a workspace takes what colcon takes, and is left out.
"""

from __future__ import annotations

import argparse
import ast
import re  # noqa: TID251  (the course's own texts)
import statistics
import subprocess
import time
from dataclasses import dataclass
from typing import TYPE_CHECKING

from jupyter_client.manager import KernelManager

from autograder import exercises
from autograder.authoring.answer_bank import answers
from autograder.safe_files import HeldFolder
from autograder.student.lab import join_domain

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from jupyter_client.blocking.client import BlockingKernelClient

LIMIT = 180.0
"""Seconds that a cell may take."""
_START = "from autograder.notebook import check, start_ros\nstart_ros()"
_READY = "from autograder.notebook.checking import judge_link\njudge_link._own_judge().path()"
_ENDED = "Runs that have ended"
_PASSED = "\nPASSED: "
_CODE_CELL = re.compile(r"^```\{code-cell\} ipython3\n(?::[^\n]*\n)*(.*?)^```$", re.DOTALL | re.MULTILINE)
_CHECK = r"^check\(\"{exercise}\", (\w+)\)$"


@dataclass(frozen=True)
class Subject:
    """An answer to be checked in a notebook.

    Attributes:
        name: Its name in the bank, or the exercise's id for the solution.
        is_right: Whether it earns full marks.
        cells: What the student's cells say.
        check: The check cell.
    """

    name: str
    is_right: bool
    cells: tuple[str, ...]
    check: str


@dataclass(frozen=True)
class Waited:
    """The seconds from the beginning of a check cell.

    Attributes:
        first: Until the first card. It may say only that the judge watches.
        ended: Until a card tells of a run that has ended; that of the complete card if there is no earlier one.
        complete: Until the complete card.
        passed: Whether the complete card says that the check is passed.
    """

    first: float
    ended: float
    complete: float
    passed: bool


def subjects(exercise_id: str) -> Iterator[Subject]:
    """The solution of an exercise, then one wrong answer of the bank for each diagnosis.

    An answer that does not define what the notebook checks, such as a program without a function, is left out.
    """
    reference = exercises.reference_path(exercise_id)
    master = (reference.parent / "lab.md").read_text(encoding="utf-8")
    found = re.search(_CHECK.format(exercise=re.escape(exercise_id)), master, re.MULTILINE)
    if exercises.get(exercise_id).runner or found is None:
        return
    given = (_START, *(definitions(cell) for cell in _CODE_CELL.findall(master[: found.start()])))
    yield Subject(exercise_id, True, given, found[0])
    diagnosed: set[tuple[str, ...]] = {()}
    for answer in answers([exercise_id]):
        if answer.diagnoses[:1] not in diagnosed:
            cell = definitions(answer.text, ast.Assign)
            if re.search(rf"^(class|def|async def) {found[1]}\b", cell, re.MULTILINE):
                diagnosed.add(answer.diagnoses[:1])
                yield Subject(answer.name, False, (*given, cell), found[0])


def definitions(program: str, *also: type[ast.stmt]) -> str:
    """What a program or cell defines: imports, functions, classes and constants, and ``also``; empty if no Python."""
    try:
        tree = ast.parse(program)
    except SyntaxError:
        return ""
    kept = (ast.Import, ast.ImportFrom, ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef, *also)
    tree.body = [node for node in tree.body if isinstance(node, kept) or _is_constant(node)]
    return ast.unparse(tree)


def _is_constant(node: ast.stmt) -> bool:
    targets = (
        node.targets
        if isinstance(node, ast.Assign)
        else [node.target]
        if isinstance(node, ast.AnnAssign)
        else []
    )
    # A type's other name, such as Point, begins with a capital, too.
    return bool(targets) and all(isinstance(one, ast.Name) and one.id[0].isupper() for one in targets)


def wait_for(subject: Subject) -> Waited:
    """Check one answer in a kernel of its own.

    Raises:
        RuntimeError: A cell ended with an error, or showed no card.
    """
    manager = KernelManager(kernel_name="python3")
    with HeldFolder("autograder-bench-") as folder:
        manager.start_kernel(stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, cwd=str(folder.path))
        client = manager.blocking_client()
        try:
            client.start_channels()
            client.wait_for_ready(timeout=LIMIT)
            for cell in (*subject.cells, _READY):
                _cards(client, cell)
            cards = _cards(client, subject.check)
        finally:
            client.stop_channels()
            manager.shutdown_kernel(now=True)
    if not cards:
        raise RuntimeError(f"{subject.name}: no card")
    complete, text = cards[-1]
    ended = next((seconds for seconds, card in cards if _ENDED in card), complete)
    return Waited(cards[0][0], ended, complete, _PASSED in text)


def _cards(client: BlockingKernelClient, cell: str) -> list[tuple[float, str]]:
    """Run a cell. Return the cards that it shows, and when."""
    began, cards, why = time.monotonic(), [], ""
    request = client.execute(cell)
    while True:
        message = client.get_iopub_msg(timeout=LIMIT)
        kind, content = message["msg_type"], message["content"]
        if message["parent_header"].get("msg_id") != request:
            continue
        if kind in ("display_data", "update_display_data"):
            cards.append((time.monotonic() - began, content["data"].get("text/plain", "")))
        elif kind == "error":
            why = f"{content['ename']}: {content['evalue']}"
        elif kind == "status" and content["execution_state"] == "idle":
            if why:
                raise RuntimeError(why)
            return cards


def main(chosen: Sequence[str], *, wrong: bool) -> None:
    """Print a table of the waits, and their medians and maxima."""
    join_domain()
    waits: dict[bool, list[Waited]] = {True: [], False: []}
    print("| check | first card | a run has ended | complete |\n| --- | ---: | ---: | ---: |")
    for exercise_id in chosen or exercises.all_ids():
        for subject in subjects(exercise_id):
            if not (subject.is_right or wrong):
                continue
            try:
                waited = wait_for(subject)
            except RuntimeError as error:
                print(f"| {subject.name} | {error} | | |", flush=True)
                continue
            # Of an answer whose mistake is outside the class or function, the notebook checks what is right.
            is_counted = waited.passed is subject.is_right
            if is_counted:
                waits[subject.is_right].append(waited)
            trouble = "" if is_counted else " (passed)" if waited.passed else " (not passed)"
            print(_row(subject.name + trouble, (waited.first, waited.ended, waited.complete)), flush=True)
    for is_right, measured in waits.items():
        columns = [
            [one.first for one in measured],
            [one.ended for one in measured],
            [one.complete for one in measured],
        ]
        if measured:
            words = f"{len(measured)} {'right' if is_right else 'wrong'}"
            print(_row(f"{words}, median", [statistics.median(column) for column in columns]))
            print(_row(f"{words}, at most", [max(column) for column in columns]))


def _row(name: str, seconds: Sequence[float]) -> str:
    return f"| {name} | {' | '.join(f'{one:.2f}' for one in seconds)} |"


if __name__ == "__main__":
    options = argparse.ArgumentParser(prog="python -m benchmarks.check_times", description=__doc__)
    options.add_argument(
        "exercises", nargs="*", metavar="EXERCISE", help="only these, such as lab_1_2.talker"
    )
    options.add_argument("--wrong", action="store_true", help="also a wrong answer of each diagnosis")
    said = options.parse_args()
    main(said.exercises, wrong=said.wrong)
