"""Who imports whom: the rules of docs/architecture.md, held to the code."""

from __future__ import annotations

import ast
import functools
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from collections.abc import Iterator

ROOT = Path(__file__).resolve().parents[1]
PACKAGE = ROOT / "autograder"
PARTS = {path.stem for path in PACKAGE.iterdir() if path.suffix == ".py" or (path / "__init__.py").exists()}
PARTS -= {"__init__"}
ALL = frozenset(PARTS)

# What a part may import of the package; what is not here may import anything but `cli`.
MAY_IMPORT = {
    "verdict": frozenset[str](),
    "exercises": frozenset[str](),
    "cards": frozenset({"verdict"}),
    "boxes": frozenset({"verdict"}),
    "masters": frozenset({"exercises"}),
    "notebook": ALL - {"judge", "exercises", "masters", "boxes", "grading", "execution", "recording"},
    "judge": ALL - {"notebook", "cards", "masters", "boxes", "grading", "execution", "recording"},
    "__main__": frozenset({"cli"}),
}


@functools.cache
def imports(folder: Path) -> list[tuple[Path, int, str]]:
    """Each import below a folder: file, line and full name, whether at the top or inside a function."""
    return list(_imports(folder))


def _imports(folder: Path) -> Iterator[tuple[Path, int, str]]:
    for path in sorted(folder.rglob("*.py")):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Import):
                yield from ((path, node.lineno, alias.name) for alias in node.names)
            elif isinstance(node, ast.ImportFrom):
                # A relative import keeps its dots, and is refused in the package: it hides who is imported.
                module = "." * node.level + (node.module or "")
                yield from ((path, node.lineno, f"{module}.{alias.name}") for alias in node.names)


def part_of(path: Path) -> str:
    """The part of the package that a file belongs to."""
    inside = path.relative_to(PACKAGE)
    return inside.parts[0].removesuffix(".py")


@pytest.mark.parametrize("part", sorted(PARTS))
def test_a_part_imports_only_what_it_may(part: str) -> None:
    allowed = MAY_IMPORT.get(part, ALL - {"cli"}) | {part}
    wrong = [
        f"{path.relative_to(ROOT)}:{line} imports {name}"
        for path, line, name in imports(PACKAGE)
        if part_of(path) == part and name.startswith("autograder.")
        # A name that is no part, such as autograder.__version__, is the package's own.
        if name.split(".")[1] in PARTS and name.split(".")[1] not in allowed
    ]
    assert not wrong, "docs/architecture.md, Who may import whom:\n" + "\n".join(wrong)


def test_the_package_names_in_full_what_it_imports() -> None:
    wrong = [f"{path}:{line}" for path, line, name in imports(PACKAGE) if name.startswith(".")]
    assert not wrong


def test_the_environment_never_imports_the_package() -> None:
    wrong = [
        f"{path}:{line}"
        for path, line, name in imports(ROOT / "environment")
        if name.startswith("autograder")
    ]
    assert not wrong


def test_dask_is_imported_where_it_is_shut_in_and_where_it_executes() -> None:
    """The courier reads no pickle; the other two run on workers. The grader itself never imports Dask."""
    found = {
        str(path.relative_to(PACKAGE))
        for path, _, name in imports(PACKAGE)
        if name.split(".")[0] in {"dask", "distributed"}
    }
    assert found == {f"grading/cluster/{name}.py" for name in ("courier", "start_worker", "worker")}


def test_every_part_has_its_line_in_the_architecture() -> None:
    text = (ROOT / "docs/architecture.md").read_text()
    table = text.partition("## The package")[2].partition("###")[0]
    missing = [
        part for part in PARTS - {"__main__"} if f"`{part}/`" not in table and f"`{part}.py`" not in table
    ]
    assert not missing


def test_every_dependency_has_its_reason_in_the_architecture() -> None:
    import tomllib

    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    extras = project["optional-dependencies"].values()
    wanted = [*project["dependencies"], *(name for extra in extras for name in extra)]
    text = (ROOT / "docs/architecture.md").read_text().partition("## Dependencies")[2]
    names = [requirement.partition(">")[0].partition("=")[0].partition("[")[0] for requirement in wanted]
    assert not [name for name in names if name not in text]
