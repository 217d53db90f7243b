"""No file that students are handed answers an exercise: what offers the same as a solution is judged."""

from __future__ import annotations

import ast
import re
import subprocess
import sys
import sysconfig
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import nbformat
import pytest

from autograder.masters.master_files import masters
from autograder.student.handout import hand_out
from tests.cases import cases

if TYPE_CHECKING:
    from collections.abc import Iterator

ROOT = Path(__file__).resolve().parents[1]
CODE = re.compile(r"^```\{code-cell\}[^\n]*\n(?::[^\n]*\n)*(.*?)^```", re.MULTILINE | re.DOTALL)
CHECK = re.compile(r'^check\("(\w+\.\w+)", (\w+)\)', re.MULTILINE)
OFFERING = {"create_service": 0, "create_publisher": 0, "create_subscription": 0, "ActionServer": 1}
"""What puts an endpoint on the graph, and which of its arguments is the type; the name comes next."""
PROGRAM = cases(__file__, "PROGRAM")
Endpoints = frozenset[tuple[str, str, str]]


@dataclass(frozen=True)
class Given:
    """A class of a node in a file.

    Attributes:
        name: Its name.
        file: Where it is.
        source: Its code.
        imports: What its file imports, of the course's own modules nothing.
    """

    name: str
    file: Path
    source: str
    imports: str


def endpoints(tree: ast.AST) -> Endpoints:
    """Kind, type and name of all that a class puts on the graph under names that it says itself."""
    found = set()
    for node in ast.walk(tree):
        if not isinstance(node, ast.Call):
            continue
        kind = getattr(node.func, "attr", getattr(node.func, "id", ""))
        at = OFFERING.get(kind)
        if at is None or len(node.args) < at + 2:
            continue
        name = node.args[at + 1]
        if isinstance(name, ast.Constant):
            found.add((kind, ast.unparse(node.args[at]), str(name.value).lstrip("/")))
    return frozenset(found)


def classes(text: str) -> Iterator[ast.ClassDef]:
    try:
        yield from (node for node in ast.walk(ast.parse(text)) if isinstance(node, ast.ClassDef))
    except (SyntaxError, ValueError):
        return


def asked_for() -> dict[str, Endpoints]:
    """What the solution of each exercise about a class puts on the graph."""
    asked: dict[str, Endpoints] = {}
    for master in masters(ROOT):
        cells = CODE.findall(master.read_text(encoding="utf-8"))
        wanted = dict(reversed(pair) for cell in cells for pair in CHECK.findall(cell))
        for cell in cells:
            asked |= {wanted[one.name]: endpoints(one) for one in classes(cell) if one.name in wanted}
    return {exercise: offered for exercise, offered in asked.items() if offered}


def code(file: Path) -> str:
    """The code of a file; of a notebook the cells that are no solutions, and of those no shell."""
    if file.suffix != ".ipynb":
        return file.read_text(encoding="utf-8", errors="replace")
    cells = [cell for cell in nbformat.read(file, as_version=4).cells if cell.cell_type == "code"]
    given = [cell.source for cell in cells if not cell.metadata.get("nbgrader", {}).get("solution")]
    return "\n\n".join(source for source in given if not source.startswith("%"))


def candidates(folder: Path, asked: dict[str, Endpoints]) -> Iterator[tuple[str, Given]]:
    """The classes below a folder that offer what a solution offers, with the exercise."""
    for file in sorted([*folder.rglob("*.ipynb"), *folder.rglob("*.py")]):
        text = code(file)
        if not any(word in text for word in OFFERING):
            continue
        lines = [
            ast.unparse(node)
            for node in ast.parse(text).body
            if isinstance(node, ast.Import | ast.ImportFrom)
        ]
        imports = "\n".join(line for line in lines if "autograder" not in line)
        for one in classes(text):
            offered = endpoints(one)
            for exercise, wanted in asked.items():
                if wanted <= offered:
                    yield exercise, Given(one.name, file, ast.unparse(one), imports)


@pytest.fixture(scope="module")
def handed_out(tmp_path_factory: pytest.TempPathFactory) -> Path:
    place = tmp_path_factory.mktemp("handed") / "course"
    hand_out(place, ROOT)
    return place


def test_what_the_solutions_offer_is_known() -> None:
    asked = asked_for()
    assert asked["lab_1_3.server"] == {("create_service", "AddTwoInts", "add_two_ints")}
    assert {"lab_1_2.talker", "lab_1_2.listener", "lab_1_4.server"} <= set(asked)


@pytest.mark.ros
@pytest.mark.slow
def test_no_class_of_a_notebook_answers_an_exercise(handed_out: Path, tmp_path: Path) -> None:
    found = list(candidates(handed_out / "chapters", asked_for()))
    assert found, "the adders of the later notebooks offer the service of Lab 1.3"
    full = []
    for number, (exercise, given) in enumerate(found):
        program = tmp_path / f"answer_{number}.py"
        program.write_text(PROGRAM.format(imports=given.imports, given=given.source, name=given.name))
        command = [sys.executable, "-m", "autograder", "check", exercise, "--", sys.executable, str(program)]
        if subprocess.run(command, capture_output=True, check=False).returncode == 0:
            full.append((exercise, given.file.name, given.name))
    assert not full


def test_no_other_file_offers_what_a_solution_offers(handed_out: Path) -> None:
    installed = Path(sysconfig.get_path("purelib"))
    assert not [
        (exercise, given.file.name)
        for folder in (
            handed_out / "autograder",
            handed_out / "course_runtime",
            handed_out / "environment",
            handed_out / "exercises",
            *installed.glob("*demo*"),
            *installed.glob("*example*"),
        )
        for exercise, given in candidates(folder, asked_for())
        if given.file.suffix == ".py"
    ]


def test_no_package_generates_interfaces(handed_out: Path) -> None:
    for folder in (handed_out, Path(sys.prefix) / "share/my_robot_interfaces"):
        lists = [
            file
            for file in folder.rglob("CMakeLists.txt")
            if "rosidl_generate_interfaces" in file.read_text()
        ]
        assert not lists
