"""Who imports whom: the rules, held to the code."""

from __future__ import annotations

import ast
import functools
import re
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from autograder import course, exercises
from tests.reach.imports import imports_of

if TYPE_CHECKING:
    from collections.abc import Iterator

ROOT = Path(__file__).resolve().parents[1]
PACKAGE = ROOT / "autograder"
PARTS = {path.stem for path in PACKAGE.iterdir() if path.suffix == ".py" or (path / "__init__.py").exists()}
PARTS -= {"__init__"}

FOR_ALL = frozenset({"command_name"})
"""What every part may import: the words of messages."""
MODULES_MAY_IMPORT = {
    "exercises": frozenset({"course", "kit"}),
    "check_journal": frozenset({"course", "verdict"}),
    "own_lines": frozenset({"messages"}),
    "interface_builder": frozenset({"safe_files", "workspaces"}),
    "__main__": frozenset({"cli", "course", "standard_output"}),
}
"""What a module of the package may import of it; a module that is not here, nothing. A folder's first page says it."""

# The parts of `notebook`: what is below knows nothing of what is above.
NOTEBOOK_MAY_IMPORT = {
    "cell_output": frozenset[str](),
    "cell_runs": frozenset({"cell_output"}),
    "nodes": frozenset({"cell_output", "cell_runs"}),
    "checking": frozenset({"cell_output", "cell_runs", "nodes"}),
    "observing": frozenset({"cell_output", "cell_runs", "checking"}),
    "robot_drivers": frozenset({"nodes"}),
    "robot_node": frozenset({"robot_drivers"}),
    "live_robot": frozenset({"nodes", "observing", "robot_drivers", "robot_node"}),
}
# The folders and files of `grading`, from the bottom up: each imports, also for types, only what stands before it.
GRADING_FROM_BELOW = (
    *("grading_errors", "grading_task", "course_version"),
    *("rebuilding", "classes", "returning", "running", "cluster"),
    *("table", "export", "class_records", "store_tables", "class_store", "class_checks"),
    *("collecting", "tasks", "result_writer", "reporting"),
    *("batch_work", "batch_steps", "batch", "nbgrader_commands", "new_classes", "week"),
)
MOST_FILES = 15
"""In one folder of the package: a stranger must be able to read their names."""


@functools.cache
def imports(folder: Path) -> list[tuple[Path, int, str]]:
    """Each import below a folder: file, line and name; a relative one keeps its dots."""
    return [
        (path, one.line, "." * one.level + one.name)
        for path in sorted(folder.rglob("*.py"))
        for one in imports_of(path)
    ]


def part_of(path: Path) -> str:
    """The part of the package that a file belongs to."""
    inside = path.relative_to(PACKAGE)
    return inside.parts[0].removesuffix(".py")


@dataclass(frozen=True)
class FirstPage:
    """The docstring of a folder's ``__init__.py``, which a reader meets first.

    Attributes:
        parts: What its lines say, by their first word.
        lines: The number of its lines.
    """

    parts: dict[str, str]
    lines: int

    def names(self, word: str) -> list[str]:
        """Return the names in one of its lines."""
        return re.findall(r"``([\w.]+)``", self.parts[word])


def first_page(folder: Path) -> FirstPage:
    """Read the first page of a folder."""
    text = ast.get_docstring(ast.parse((folder / "__init__.py").read_text(encoding="utf-8"))) or ""
    return FirstPage(
        dict(re.findall(r"^(\w+): ((?:.+\n?(?!\w+:))+)", text.partition("\n\n")[2], re.MULTILINE)),
        text.count("\n") + 1,
    )


FOLDERS = sorted(part for part in PARTS if (PACKAGE / part).is_dir())


@pytest.mark.parametrize("part", FOLDERS)
def test_the_first_page_of_a_folder_is_true(part: str) -> None:
    page = first_page(PACKAGE / part)
    assert list(page.parts) == ["Promises", "Names", "Imports", "Takes", "Gives"]
    assert page.lines <= 20
    assert set(page.names("Imports")) == imported_parts(part) - FOR_ALL
    assert missing_names(" ".join(f"autograder.{part}.{name}" for name in page.names("Names"))) == []


@pytest.mark.parametrize("part", sorted(PARTS - {*FOLDERS}))
def test_a_module_of_the_package_imports_only_what_it_may(part: str) -> None:
    assert imported_parts(part) - FOR_ALL == MODULES_MAY_IMPORT.get(part, frozenset())


def imported_parts(part: str) -> set[str]:
    """Return the other parts of the package from which one imports something."""
    names = [
        name.split(".")[1]
        for path, _, name in imports(PACKAGE)
        if part_of(path) == part and name.startswith("autograder.")
    ]
    # A name that is no part, such as autograder.__version__, is the package's own.
    return {name for name in names if name in PARTS} - {part}


NEVER = {
    "judge": {"notebook", "cards", "masters", "boxes", "execution", "grading", "authoring", "appeals"},
    "notebook": {"judge", "exercises", "kit", "masters", "boxes", "execution", "grading", "authoring"},
    "appeals": {"grading", "boxes", "execution", "notebook"},
}
"""What a first page may not be changed to: the judge knows no grader, a kernel no secret, and an appeal no class."""


@pytest.mark.parametrize("part", sorted(NEVER))
def test_some_parts_never_meet(part: str) -> None:
    assert not imported_parts(part) & NEVER[part]


def test_one_part_knows_that_a_wheel_has_another_command_than_a_clone() -> None:
    asking = {
        part_of(path) for path, _, name in imports(PACKAGE) if name == "course_runtime.installation.COMMAND"
    }
    assert asking == {"command_name"}


@pytest.mark.parametrize("part", sorted(NOTEBOOK_MAY_IMPORT))
def test_a_part_of_the_notebook_imports_only_what_is_below(part: str) -> None:
    allowed = NOTEBOOK_MAY_IMPORT[part] | {part}
    wrong = [
        f"{path.relative_to(ROOT)}:{line} imports {name}"
        for path, line, name in imports(PACKAGE / "notebook")
        if path.relative_to(PACKAGE / "notebook").parts[0].removesuffix(".py") == part
        if name.startswith("autograder.notebook.") and name.split(".")[2] not in allowed
    ]
    assert not wrong, "\n".join(wrong)


def arrows_up(folder: Path, from_below: tuple[str, ...]) -> list[str]:
    """Return the imports in a folder of the package, also those for types, of what stands later in an order.

    Args:
        folder: The folder.
        from_below: The names of everything in the folder, in the order.
    """
    return [
        f"{path.relative_to(folder)}:{line} imports {name}"
        for path, line, name in imports(folder)
        if name.startswith(f"{PACKAGE.name}.{folder.name}.")
        and from_below.index(path.relative_to(folder).parts[0].removesuffix(".py"))
        < from_below.index(name.split(".")[2])
    ]


def test_nothing_in_grading_imports_what_is_above_it() -> None:
    folder = PACKAGE / "grading"
    parts = {
        path.stem for path in folder.iterdir() if path.suffix == ".py" or (path / "__init__.py").exists()
    }
    assert sorted(GRADING_FROM_BELOW) == sorted(parts - {"__init__"})
    assert not arrows_up(folder, GRADING_FROM_BELOW)
    assert arrows_up(folder, GRADING_FROM_BELOW[::-1])


def test_what_was_handed_in_is_parsed_by_a_desk_alone() -> None:
    of_the_class = {"rebuilding/named_cells.py", "collecting/file_to_grade.py"}  # its own sources
    users = {
        path.relative_to(PACKAGE / "grading").as_posix()
        for path, _, name in imports(PACKAGE)
        if name
        in (
            "autograder.grading.rebuilding.notebook_parsing.parse",
            "autograder.grading.rebuilding.notebook_parsing",
        )
    }
    assert users == of_the_class


PARSERS = (
    "ast",
    "bs4",
    "catkin_pkg",
    "codeop",
    "difflib",
    "html.parser",
    "IPython",
    "mistune",
    "nbconvert",
    "pygments",
    "tokenize",
    "xml",
    "yaml",
)
MAY_PARSE = {
    "cards/card_content.py": "difflib",  # two texts of at most 120 characters
    "grading/collecting/lms_lists.py": "yaml",  # at a desk
    "grading/nbgrader_commands.py": "nbconvert",  # has nbgrader use our pages
    "grading/rebuilding/cell_matching.py": "ast",  # the stubs of the master
    "grading/rebuilding/trusted_master.py": "ast",  # the master
    "grading/returning/page_exporter.py": "nbconvert",  # the course's own text
    "workspaces/builds/plain_packages.py": "ast",  # a setup.py of at most 50,000 bytes
    "workspaces/builds/simplified_sources.py": "xml",  # a package.xml of at most 20,000 bytes
    "workspaces/packages.py": "ast catkin_pkg xml",  # files of at most 50,000 bytes, 100,000 together
}
"""What parses text in the processes of the grader, and why a student's text cannot keep them busy."""


def test_a_students_text_is_parsed_by_no_process_that_others_wait_for() -> None:
    """Parsers take quadratic time for some texts, and nothing interrupts them."""
    used: dict[str, set[str]] = {}
    for part in ("boxes", "cards", "execution", "grading", "messages", "workspaces"):
        for path, _, name in imports(PACKAGE / part):
            for parser in PARSERS:
                if f"{name}.".startswith(f"{parser}."):
                    used.setdefault(path.relative_to(PACKAGE).as_posix(), set()).add(parser)

    assert used == {path: set(parsers.split()) for path, parsers in MAY_PARSE.items()}


def test_the_process_with_the_gradebook_imports_nothing_that_executes_a_submission() -> None:
    """The executor process is started by the name of its module; the judge, too."""
    graph = {module: _runs(path, module, types=False) for module, path in _modules(PACKAGE).items()}
    reached = _reached("autograder.grading.batch", graph)
    executing = (
        "autograder.judge.",
        "autograder.notebook.",
        "autograder.workspaces.",
        "autograder.execution.notebook_runner",
    )
    but = {"autograder.judge.ros_setup"}  # the variables of ROS, for the fork servers
    assert "autograder.grading.running.process_link" in reached
    assert [name for name in sorted(reached - but) if name.startswith(executing)] == []
    assert "autograder.grading.running.order_executor" not in reached


def test_no_answer_of_a_student_is_judged_on_paper() -> None:
    """On paper there are no executors, no stacks and no discovery: only the solution and its mutants run there."""
    graph = {module: _runs(path, module, types=False) for module, path in _modules(PACKAGE).items()}
    paper = "autograder.authoring.paper."
    judging = (
        "judge",
        "notebook",
        "grading",
        "appeals",
        "execution",
        "workspaces",
        "boxes",
        "student",
        "kit",
    )
    graph["judges"] = {
        module for module in graph if module.split(".")[1:2] and module.split(".")[1] in judging
    }
    assert "autograder.judge.one_check" in graph["judges"]
    assert [name for name in _reached("judges", graph) if name.startswith(paper)] == []
    assert any(name.startswith(paper) for name in _reached("autograder.authoring.exercise_trial", graph))


def test_the_grader_reads_no_master() -> None:
    """Reading one loads Jupytext, which takes a tenth of a second in each process that grades."""
    graph = {module: _runs(path, module, types=False) for module, path in _modules(PACKAGE).items()}
    reached = _reached("autograder.grading.rebuilding.trusted_master", graph)
    assert "autograder.masters.notebook_release" in reached
    assert "autograder.masters.master_cells" not in reached


def test_no_folder_of_the_package_is_a_long_list() -> None:
    counts = {path.parent: len(list(path.parent.glob("*.py"))) for path in PACKAGE.rglob("*.py")}
    wrong = [f"{folder.relative_to(ROOT)}: {count}" for folder, count in counts.items() if count > MOST_FILES]
    assert not wrong, "group these by what they are for:\n" + "\n".join(wrong)


def test_the_package_names_in_full_what_it_imports() -> None:
    wrong = [f"{path}:{line}" for path, line, name in imports(PACKAGE) if name.startswith(".")]
    assert not wrong


ABOVE = {
    "course_runtime": ("autograder", "environment"),
    "environment": ("autograder",),
    "autograder": ("environment",),
}
"""What each folder must not import: the runtime is below the package and the set-up, which never meet."""


@pytest.mark.parametrize("folder", ABOVE)
def test_the_runtime_is_below_the_package_and_the_set_up(folder: str) -> None:
    wrong = [
        f"{path}:{line} imports {name}"
        for path, line, name in imports(ROOT / folder)
        if name.partition(".")[0] in ABOVE[folder]
    ]
    assert not wrong, "\n".join(wrong)


def circles(folder: Path, *, types: bool = False) -> list[list[str]]:
    """Modules below a folder that import each other in a circle, also from within a function.

    What is imported for types alone counts where it is asked for: it does not run.
    """
    graph = {module: _runs(path, module, types=types) for module, path in _modules(folder).items()}
    reach = {module: _reached(module, graph) for module in graph}
    found = {tuple(sorted(other for other in reach[m] if m in reach[other])) for m in graph if m in reach[m]}
    return sorted(map(list, found))


@functools.cache
def _modules(folder: Path) -> dict[str, Path]:
    names = {path: path.relative_to(folder.parent).with_suffix("").parts for path in folder.rglob("*.py")}
    return {".".join(parts).removesuffix(".__init__"): path for path, parts in names.items()}


def _runs(path: Path, module: str, *, types: bool) -> set[str]:
    """The full names of what a module imports when it runs; each may be a module or something in one."""
    return {
        one.full(one.name, module, is_package=path.name == "__init__.py")
        for one in imports_of(path)
        if types or not one.for_types
    }


def _reached(module: str, graph: dict[str, set[str]]) -> set[str]:
    reached: set[str] = set()
    waiting = [module]
    while waiting:
        for name in graph[waiting.pop()]:
            # The module itself, or the one that has what is imported from it.
            imported = name if name in graph else name.rpartition(".")[0]
            if imported in graph and imported not in reached:
                reached.add(imported)
                waiting.append(imported)
    return reached


@pytest.mark.parametrize(
    "folder", ["autograder", "course_runtime", "environment", "course_runtime/launch_front/launch"]
)
def test_no_modules_import_each_other_in_a_circle(folder: str) -> None:
    assert not circles(ROOT / folder)


def test_modules_name_each_others_types_in_a_circle_in_two_rooms_alone() -> None:
    """There each type needs the others: a world on paper, and the evidence with those who read it."""
    rooms = ("autograder.authoring.paper.", "autograder.kit.")
    found = circles(PACKAGE, types=True)
    assert [
        one for one in found if not any(all(name.startswith(room) for name in one) for room in rooms)
    ] == []


def test_the_course_s_own_ros2_may_be_taken_out() -> None:
    """The package runs the program ``ros2`` that is installed, whoever has made it."""
    assert [
        path for path, _, name in imports(PACKAGE) if name.startswith("course_runtime.ros2_command")
    ] == []
    assert any(name.startswith("course_runtime.ros2_command") for _, _, name in imports(ROOT / "environment"))


def test_a_circle_is_found_wherever_the_import_stands(tmp_path: Path) -> None:
    texts = {
        "a.py": "from typing import TYPE_CHECKING\nif TYPE_CHECKING:\n    import pkg.c\nfrom pkg.b import one\n",
        "b.py": "one = 1\n\ndef use():\n    from . import c\n",
        "c.py": "from typing import TYPE_CHECKING\nimport pkg.b\nif TYPE_CHECKING:\n    import pkg.a\n",
        "d.py": "from pkg import a\n",
        "__init__.py": "",
    }
    (tmp_path / "pkg").mkdir()
    for name, text in texts.items():
        (tmp_path / "pkg" / name).write_text(text)
    assert circles(tmp_path / "pkg") == [["pkg.b", "pkg.c"]]
    assert circles(tmp_path / "pkg", types=True) == [["pkg.a", "pkg.b", "pkg.c"]]


def test_dask_is_imported_where_it_is_shut_in_and_where_it_executes() -> None:
    """The client process reads no pickle; the other two run on workers. The grader itself never imports Dask."""
    found = {
        str(path.relative_to(PACKAGE))
        for path, _, name in imports(PACKAGE)
        if name.split(".")[0] in {"dask", "distributed"}
    }
    assert found == {f"grading/cluster/{name}.py" for name in ("dask_client", "dask_worker")}


def test_what_a_text_of_the_package_names_exists() -> None:
    """A docstring would mislead, and a fork server skips modules that it cannot import."""
    wrong = [
        f"{path.relative_to(ROOT)}: {name}"
        for path in sorted(PACKAGE.rglob("*.py"))
        for name in missing_names(path.read_text(encoding="utf-8"))
    ]
    assert not wrong, "\n".join(wrong)


def missing_names(text: str) -> list[str]:
    """Return the names in a text, such as ``autograder.verdict.Verdict``, that are neither a module nor in one."""
    modules = _modules(PACKAGE)
    wrong = []
    for found in re.finditer(r"\bautograder(?:\.[a-z_]\w*)+(?:\.[A-Z]\w*)?", text):
        name, rest = found[0], ""
        while name not in modules:
            name, _, rest = name.rpartition(".")
        if rest and rest not in _defined(modules[name]):
            wrong.append(found[0])
    return wrong


@functools.cache
def _defined(path: Path) -> set[str]:
    """Return the names of the functions and classes in a module, of its variables, and of what a package hands on."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    names = {
        node.id for node in ast.walk(tree) if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store)
    }
    kinds = (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)
    if path.name == "__init__.py":
        names |= {one.name.rpartition(".")[2] for one in imports_of(path)}
    return names | {node.name for node in tree.body if isinstance(node, kinds)}


def test_a_name_of_a_module_that_has_moved_is_found() -> None:
    text = (
        "See :mod:`autograder.verdict`, :class:`autograder.verdict.Verdict` and :mod:`autograder.gone.away`."
    )
    assert missing_names(text) == ["autograder.gone.away"]


def test_every_part_has_its_line_in_the_architecture() -> None:
    text = (ROOT / "docs/architecture.md").read_text()
    table = text.partition("## The package")[2].partition("###")[0]
    missing = [
        part for part in PARTS - {"__main__"} if f"`{part}/`" not in table and f"`{part}.py`" not in table
    ]
    assert not missing


def test_every_dependency_has_its_reason() -> None:
    import tomllib

    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    extras = project["optional-dependencies"].values()
    wanted = [*project["dependencies"], *(name for extra in extras for name in extra)]
    text = (ROOT / "docs/decisions.md").read_text().partition("## Dependencies")[2]
    # An extra may name another extra of this project.
    wanted = [name for name in wanted if not name.startswith(project["name"])]
    names = [requirement.partition(">")[0].partition("=")[0].partition("[")[0] for requirement in wanted]
    assert not [name for name in names if name not in text]


def test_the_engine_knows_no_lab() -> None:
    """A second chapter needs no line of the package: what is a fact of a lab stands in its folder."""
    # The name of a lab such as `summary` is an ordinary word, too: there only the ids of its exercises tell.
    ids = exercises.all_ids()
    labs = {*ids, *(lab for lab, _, _ in (one.partition(".") for one in ids) if "_" in lab)}
    interfaces = course.interfaces()
    wrong = [
        f"{path.relative_to(ROOT)}:{constant.lineno} says {constant.value!r}"
        for path in sorted(PACKAGE.rglob("*.py"))
        for constant in strings_of_code(ast.parse(path.read_text(encoding="utf-8")))
        if any(name in str(constant.value) for name in (*labs, *interfaces))
    ]
    assert not wrong, "\n".join(wrong)


def strings_of_code(tree: ast.AST) -> Iterator[ast.Constant]:
    """The strings of a module that it does something with: no docstring is among them."""
    texts = {
        id(node.value)
        for node in ast.walk(tree)
        if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)
    }
    for node in ast.walk(tree):
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) not in texts:
            yield node
