"""A kernel in which the given cells have not run: which of them a check needs, and what a NameError says."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import pytest
from IPython.core.inputtransformer2 import TransformerManager
from jupyter_client.manager import start_new_kernel

from autograder import course
from autograder.masters.source_notebooks import SET_UP_CELL as SET_UP_CELL
from autograder.student import fresh_kernel
from autograder.student.lab import NOTEBOOKS_VARIABLE
from autograder.student.progress import notebook_path
from tests.cases import cases

if TYPE_CHECKING:
    from collections.abc import Iterator

SETUP = "from autograder.notebook import check, start_ros\nfrom rclpy.node import Node\nstart_ros()"
CHECK = "check('lab', Talker)"


class FakeShell:
    """The shell of a kernel that has some names."""

    def __init__(self, *names: str) -> None:
        self.user_ns = dict.fromkeys(names)
        self.transform_cell = TransformerManager().transform_cell  # type: ignore[no-untyped-call]


def to_run(monkeypatch: pytest.MonkeyPatch, cells: list[str], own: list[int], *known: str) -> list[int]:
    shell = FakeShell(*known)
    monkeypatch.setattr(fresh_kernel, "get_ipython", lambda: shell)
    found: list[int] = json.loads(fresh_kernel.cells_to_run(cells, own))
    return found


NEEDS = cases(__file__, "needs")


@pytest.mark.parametrize("name", NEEDS)
def test_a_check_needs_the_cells_that_define_what_it_reads(
    monkeypatch: pytest.MonkeyPatch, name: str
) -> None:
    case = NEEDS[name]
    found = to_run(monkeypatch, [SETUP, *case["cells"]], [*case["own"]], *case["known"])
    assert found == [*case["runs"]]


def checks() -> Iterator[Any]:
    chapters = course.root() / course.CHAPTERS
    for chapter in course.chapters(course.root()):
        for lab in chapter.labs:
            cells = json.loads(notebook_path(chapter, lab, chapters).read_text(encoding="utf-8"))["cells"]
            code = [cell for cell in cells if cell["cell_type"] == "code" and cell["id"] != SET_UP_CELL]
            sources = ["".join(cell["source"]) for cell in code]
            for place, source in enumerate(sources):
                if source.startswith("check("):
                    yield pytest.param(sources[: place + 1], id=source.partition(",")[0])


@pytest.mark.parametrize("cells", list(checks()))
def test_each_check_of_the_course_needs_the_first_cell_that_is_not_the_set_up(
    monkeypatch: pytest.MonkeyPatch, cells: list[str]
) -> None:
    assert to_run(monkeypatch, cells, [len(cells) - 1])[0] == 0


@pytest.fixture(scope="module")
def new_kernel() -> Iterator[Any]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv(NOTEBOOKS_VARIABLE, "/somewhere")
        manager, client = start_new_kernel(kernel_name="python3")
        yield client
        client.stop_channels()
        manager.shutdown_kernel(now=True)


def error_of(kernel: Any, source: str) -> str:
    said: list[Any] = []
    kernel.execute_interactive(source, output_hook=said.append, timeout=180)
    return "\n".join(line for one in said for line in one["content"].get("traceback", []))


def test_a_check_in_a_new_kernel_says_what_to_run_first(new_kernel: Any) -> None:
    said = error_of(new_kernel, CHECK)
    assert said.startswith("NameError: there is no check yet. This kernel is new")
    assert "Run All Above Selected Cell" in said
    assert "Traceback" in error_of(new_kernel, "1 / 0")
