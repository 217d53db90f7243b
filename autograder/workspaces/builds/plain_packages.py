"""Builds a Python package once for all texts of its modules.

setuptools copies modules without reading them, unless setup.py asks for more. A package is *plain* if its setup.py is
like the one that `ros2 pkg create` writes: it only calls ``setup`` with fixed values. A plain package is built with a
placeholder in each of its modules. In a copy of this build, the texts then replace the placeholders. The result is the
same, byte for byte, as that of a build with these texts, but `colcon` does not run for each of them.
"""

from __future__ import annotations

import ast
import configparser
import sys
from dataclasses import replace
from pathlib import PurePosixPath
from typing import TYPE_CHECKING

import msgspec

from autograder.workspaces.packages import MAX_SETUP, UNREADABLE
from autograder.workspaces.sources import SourceTree

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from autograder.messages.workspace_messages import Source
    from autograder.workspaces.jobs import BuildJob
    from autograder.workspaces.packages import Package


def split(job: BuildJob) -> list[BuildJob]:
    """Return the builds that make up a build: first of the other packages, then of the plain ones with placeholders.

    The result is the job itself if it has no plain package, or if it already has the placeholders.
    """
    files = {package.folder: _files(job.tree, package) for package in job.packages}
    plain = [package for package in job.packages if _is_plain(files[package.folder])]
    others = [package for package in job.packages if package not in plain]
    if not plain:
        return [job]
    blank = [_blank(path, source) for package in plain for path, source in files[package.folder].items()]
    rest = [source for package in others for source in files[package.folder].values()]
    parts = [replace(job, tree=SourceTree(tuple(rest)), packages=others)] if others else []
    return [*parts, replace(job, tree=SourceTree(tuple(blank)), packages=plain, cmake=())]


def put_texts(tree: SourceTree, install: Path) -> None:
    """Replace the placeholders in a copy of a build by the texts of the modules."""
    texts = {_placeholder(source): source.data for source in tree.sources}
    for file in install.rglob("*.py"):
        if (text := texts.get(file.read_bytes())) is not None:
            file.write_bytes(text)


def _files(tree: SourceTree, package: Package) -> dict[PurePosixPath, Source]:
    """Return the files and folders of a package, by their paths in the package."""
    folder = PurePosixPath(*package.folder.parts[1:])  # the first part is "src"
    sources = {PurePosixPath(source.path): source for source in tree.sources}
    return {path.relative_to(folder): sources[path] for path in sources if path.is_relative_to(folder)}


def _blank(path: PurePosixPath, source: Source) -> Source:
    """Return a source of a plain package, with a placeholder as its text if it is a module.

    Files next to setup.py stay as they are, because setuptools and Python might use them in a build.
    """
    is_module = path.suffix == ".py" and len(path.parts) > 1 and source.data is not None
    return msgspec.structs.replace(source, data=_placeholder(source)) if is_module else source


def _placeholder(source: Source) -> bytes:
    return f"# the text of {source.path!r}\n".encode()


_SYNTAX = (
    *(ast.Module, ast.ImportFrom, ast.alias, ast.Assign, ast.Expr, ast.Call, ast.keyword, ast.expr_context),
    *(ast.Name, ast.Constant, ast.List, ast.Tuple, ast.Dict, ast.BinOp, ast.Add),
)
"""The syntax of a plain setup.py. With it, a program can only call functions with fixed values."""
_FUNCTIONS = {"setup", "find_packages"}
_ARGUMENTS = {
    *("name", "version", "packages", "exclude", "data_files", "install_requires", "zip_safe", "entry_points"),
    *("author", "author_email", "maintainer", "maintainer_email", "keywords", "classifiers"),
    *("description", "license", "tests_require", "extras_require"),
}
"""Arguments for which setuptools reads no module. For example, ``scripts`` changes the first line of a file."""
_SECTIONS = {"develop", "install"}
"""The sections of a plain setup.cfg. For example, ``[metadata]`` may take a value from a module."""


def _is_plain(files: Mapping[PurePosixPath, Source]) -> bool:
    """Return True if the build of a package cannot depend on the texts of its modules.

    Args:
        files: The files and folders of the package, by their paths in it.
    """
    top = {path.name: source.data or b"" for path, source in files.items() if len(path.parts) == 1}
    imported = {path.parts[0] for path in files if path.name == "__init__.py"}
    return (
        "pyproject.toml" not in top
        and [name for name in top if name.endswith(".py")] == ["setup.py"]
        # setup.py would import these from the package's folder.
        and imported.isdisjoint({*sys.stdlib_module_names, "setuptools"})
        and _only_calls_setup(top["setup.py"])
        and _only_places_programs(top.get("setup.cfg", b""))
    )


def _only_calls_setup(text: bytes) -> bool:
    try:
        nodes = list(ast.walk(ast.parse(text if len(text) <= MAX_SETUP else b"-")))
    except UNREADABLE:
        return False
    return all(isinstance(node, _SYNTAX) and _is_allowed(node) for node in nodes)


def _is_allowed(node: ast.AST) -> bool:
    match node:
        case ast.ImportFrom(module=module):
            return module == "setuptools"
        case ast.alias(name=name):
            return name in _FUNCTIONS
        case ast.Call(func=function):
            return isinstance(function, ast.Name) and function.id in _FUNCTIONS
        case ast.keyword(arg=name):
            return name in _ARGUMENTS
    return True


def _only_places_programs(text: bytes) -> bool:
    parser = configparser.RawConfigParser()
    try:
        parser.read_string(text.decode())
    except (configparser.Error, UnicodeDecodeError):
        return False
    return _SECTIONS.issuperset(parser.sections())
