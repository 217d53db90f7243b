"""The files of a repository like this one, its tests and its exercises: from these all paths of the graph begin."""

from __future__ import annotations

import subprocess
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING

from tests.reach.graph import WHOLE, Files, Graph, Node
from tests.reach.pieces import REST, Source, read

if TYPE_CHECKING:
    from collections.abc import Iterable

STRANGERS = (
    ".answers/",
    "tests/submissions/",
    "tests/attacks/bank/",
    "tests/attacks/parts/",
    "_ws/",
    "/examples/",
)
"""Programs that the course's own code runs, and never imports."""
NAMING = {".toml", ".j2", ".json"}
"""The ends of the names of the engine's files in which the name of a module has it imported."""
HOOK = "pytest_"


def listed(root: Path) -> list[str]:
    """Return the paths of all files of a repository, also of those that are not committed yet."""
    command = ["git", "ls-files", "--cached", "--others", "--exclude-standard"]
    done = subprocess.run(command, cwd=root, capture_output=True, text=True, check=True)
    return [path for path in done.stdout.splitlines() if (root / path).is_file()]


def is_source(path: str) -> bool:
    """Return whether a file is Python that others may import."""
    return path.endswith(".py") and not any(part in path for part in STRANGERS)


def module_name(path: str) -> str:
    """Return the name by which a Python file is imported: that of ``solutions/…/lab_1_2/talker.py`` is its id."""
    parts = PurePosixPath(path).with_suffix("").parts
    if parts[0] == "solutions":
        parts = parts[2:]
    return ".".join(parts).removesuffix(".__init__")


def read_files(root: Path, paths: Iterable[str]) -> Files:
    """Read the files of a repository."""
    sources: dict[str, Source] = {}
    data: dict[str, str] = {}
    for path in paths:
        if is_source(path):
            sources[path] = read((root / path).read_text(encoding="utf-8"))
        else:
            names_modules = PurePosixPath(path).suffix in NAMING and path.startswith(
                ("autograder/", "course_runtime/", "environment/")
            )
            data[path] = (root / path).read_text(encoding="utf-8") if names_modules else ""
    return Files(sources, data, {module_name(path): path for path in sources})


def exercises_of(files: Files) -> dict[str, Node]:
    """Return the exercises by their ids."""
    modules = ((name, path) for name, path in files.modules.items() if path.startswith("solutions/"))
    return {name: (path, WHOLE) for name, path in modules if "." in name and "._" not in name}


def tests_of(graph: Graph) -> list[Node]:
    """Lead each test, and each fixture, to the fixtures that it uses. Return the tests."""
    sources = graph.files.sources
    tests: list[Node] = []
    for path in (path for path in sources if path.startswith("tests/")):
        around = [f"{folder}/conftest.py" for folder in PurePosixPath(path).parents]
        places = [path, *(one for one in around if one in sources)]
        everywhere = {
            (place, name)
            for place in places
            for name, one in sources[place].pieces.items()
            if one.is_everywhere
        }
        for name, piece in sources[path].pieces.items():
            node = path, name
            is_test = name.startswith("test_") and "/test_" in path
            if is_test:
                tests.append(node)
                graph.edges[node] |= {(place, REST) for place in places} | everywhere
            if is_test or any(one.endswith("fixture") for one in piece.decorators):
                for parameter in piece.parameters:
                    graph.edges[node] |= set(_fixture(graph, places, parameter))
    return tests


def _fixture(graph: Graph, places: list[str], name: str) -> set[Node]:
    for place in places:
        if found := set(graph.mentioned(place, name)):
            return found
    return set()
