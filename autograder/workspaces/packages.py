"""The packages in a workspace's ``src`` folder, as their files describe them; and the workspace of a launch file.

A package is described by its package.xml, and by the entry points in its setup.py or the programs in its
CMakeLists.txt.
"""

from __future__ import annotations

import ast
import os
from dataclasses import dataclass
from functools import cached_property
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING
from xml.etree import ElementTree
from xml.parsers.expat import ExpatError

import re2

from autograder.workspaces.sources import BadSources, ByteBudget, SourceTree, is_source, read_sources

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from autograder.messages.workspace_messages import Source


WORKSPACE = "ros2_ws"
"""The name of the workspace folder in all labs."""
DEFINITIONS = (".msg", ".srv", ".action")
"""The file name extensions of interface files."""
FOR_READERS = ("LICENSE", "README.md", "README.rst", "CHANGELOG.rst")
"""Files of a package that people read and builds do not."""
UNREADABLE = (SyntaxError, ValueError, LookupError, RecursionError, MemoryError)
"""The errors that Python's parsers for Python and XML raise if a text is malformed, has an unknown encoding, or is too
deeply nested.
"""
LAUNCH_LANGUAGES = (".py", ".xml", ".yaml", ".yml")
"""The file name extensions of launch files, in all languages and spellings."""
MAX_FILES = 5_000
MAX_BYTES = 100_000_000
"""The maximum numbers of files and bytes of sources. If a path has more, it is not a workspace."""
MAX_PACKAGES = 50
"""The maximum number of packages to read; a workspace of the course has a few."""
MAX_PACKAGE_XML = 20_000
"""The maximum size of a package.xml in bytes; a usual file has a few thousand.

The limit is needed because validating takes quadratic time. Entities (``<!ENTITY``) are refused, because they let two
thousand bytes expand to eight million.
"""
MAX_SETUP = 10_000
"""The maximum size of a setup.py in bytes; a usual file has a thousand. It is needed because Python's parser takes time
that grows with the square of an f-string's length: a fortieth of a second for this many bytes, minutes for half a
megabyte.
"""
MAX_CMAKE_LISTS = 50_000
"""The maximum size of a CMakeLists.txt in bytes."""
MAX_LOOK = 100_000
"""The maximum number of bytes, of all packages together, that slow parsers read. Python's parser and catkin_pkg need
half a second for the largest allowed file. A file beyond this limit is skipped; it is not reported as missing or wrong.
"""


@dataclass(frozen=True)
class Package:
    """A package of the workspace.

    Attributes:
        name: The package's name in its package.xml.
        folder: The folder of the package.
        build_type: The build type, such as ``"ament_python"``; empty if package.xml has none.
        dependencies: The names of the packages on which it depends, and of the groups of which it is a member.
    """

    name: str
    folder: Path
    build_type: str
    dependencies: tuple[str, ...] = ()

    @property
    def commented(self) -> tuple[str, ...]:
        """The dependencies that package.xml contains only inside comments, so they have no effect."""
        comments = re2.findall(r"(?s)<!--(.*?)-->", _text(self.folder / "package.xml"))
        line = r"<(?:\w*depend|member_of_group)\b[^>]*>\s*([^<\s]+)\s*</"
        return tuple(name for comment in comments for name in re2.findall(line, comment))

    @property
    def interface_files(self) -> tuple[Path, ...]:
        """The package's .msg, .srv and .action files, as paths inside the package."""
        found = (file for ending in DEFINITIONS for file in self.folder.rglob(f"*{ending}"))
        return tuple(sorted(file.relative_to(self.folder) for file in found if file.is_file()))

    @property
    def modules(self) -> tuple[Path, ...]:
        """The package's Python files, as paths inside the package, least nested first."""
        found = [file.relative_to(self.folder) for file in self.folder.rglob("*.py") if file.is_file()]
        return tuple(sorted(found, key=lambda file: (len(file.parts), file)))

    @cached_property
    def cmake_lists(self) -> str | None:
        """The package's CMakeLists.txt without comments; empty if it does not exist, None if it is too long."""
        text = _text(self.folder / "CMakeLists.txt")
        if len(text) > MAX_CMAKE_LISTS:
            return None
        return "\n".join(line.partition("#")[0] for line in text.split("\n"))

    @property
    def programs(self) -> tuple[str, ...]:
        """The console scripts that are written in setup.py.

        The file is not run, only read: every text in it of the form ``name = module:function`` counts. So names that
        setup.py computes, and names in setup.cfg, are known only after the build.
        """
        strings = _strings(ast.walk(self._setup))
        return tuple(line.strip() for text in strings for line in text.splitlines() if is_entry_point(line))

    @property
    def bad_entry_point(self) -> str:
        """What is wrong with the first entry point in setup.py that setuptools refuses; empty if all are valid."""
        listed = console_scripts(self._setup)
        strings = _strings(listed.elts if listed else ())
        return next((objection(text) for text in strings if not is_entry_point(text)), "")

    @property
    def _setup(self) -> ast.Module:
        """The syntax tree of setup.py; an empty tree if the file does not exist, is too long or is not valid Python."""
        text = _text(self.folder / "setup.py")
        try:
            return ast.parse(text if len(text) <= MAX_SETUP else "")
        except UNREADABLE:
            return ast.parse("")

    @property
    def holds_only_interfaces(self) -> bool:
        """True if the package contains nothing but interfaces, the files with which they are built, and texts."""
        files = [path for path in self.folder.rglob("*") if path.is_file()]
        known = {"package.xml", "CMakeLists.txt", *FOR_READERS}
        return (
            self.build_type == "ament_cmake"
            and any(path.suffix in DEFINITIONS for path in files)
            and all(
                path.suffix in DEFINITIONS or path.relative_to(self.folder).as_posix() in known
                for path in files
            )
            and self.cmake_lists is not None
            and "_cpp" not in self.cmake_lists
        )


def find_packages(src: Path) -> tuple[list[Package], list[str]]:
    """Return the packages below ``src`` that colcon would build, sorted by name.

    The second result contains a sentence for each unusable package, which says what is wrong with it.
    """
    packages, unusable, budget = [], [], ByteBudget(MAX_LOOK)
    files = sorted(islice(_package_files(src), MAX_PACKAGES + 1))
    if len(files) > MAX_PACKAGES:
        return [], [f"there are more than {MAX_PACKAGES} packages below {src.name}"]
    for file in files:
        try:
            packages.append(_package(file, budget))
        except _BadPackage as error:
            unusable.append(str(error))
    return sorted(packages, key=lambda package: package.name), unusable


_HIDING = ("COLCON_IGNORE", "AMENT_IGNORE", "CATKIN_IGNORE")


def _package_files(src: Path) -> Iterator[Path]:
    for root, folders, names in os.walk(src):
        folders[:] = filter(is_source, folders)
        if any(name in names for name in _HIDING):
            folders[:] = []
        elif "package.xml" in names:
            folders[:] = []  # colcon does not look for packages inside other packages
            yield Path(root, "package.xml")


class _BadPackage(ValueError):
    """A package.xml cannot be used. The exception's text says why, in words for a student."""


def _package(file: Path, budget: ByteBudget) -> Package:
    shown = f"{file.parent.name}/package.xml"
    try:
        with file.open("rb") as opened:
            text = opened.read(MAX_PACKAGE_XML + 1)
    except OSError as error:
        raise _BadPackage(f"{shown} cannot be read: {error.strerror}") from error
    if len(text) > MAX_PACKAGE_XML:
        raise _BadPackage(f"{shown} is larger than {MAX_PACKAGE_XML // 1000} kB")
    if b"\0" in text:
        # Refuse UTF-16, which contains zero bytes: the tools of ROS read only UTF-8, and "<!ENTITY" could not be found.
        raise _BadPackage(f"{shown} is not valid: save it in UTF-8")
    if b"<!ENTITY" in text:
        raise _BadPackage(f"{shown} declares an entity with <!ENTITY: replace the entity by its text")
    try:
        root = ElementTree.fromstring(text)
    except UNREADABLE as error:
        raise _BadPackage(f"{shown} is not valid XML: {_told(error)}") from error
    name = (root.findtext("name") or "").strip()
    if not name:
        raise _BadPackage(f"{shown} has no <name>")
    if budget.has(file):
        _validate(file, shown)
    depends = [
        child.text.strip() for child in root if child.text and re2.search("depend|member_of", child.tag)
    ]
    build_type = (root.findtext("export/build_type") or "").strip()
    return Package(name, file.parent, build_type, tuple(depends))


def _validate(file: Path, shown: str) -> None:
    # Check package.xml here: if it is invalid, colcon silently treats the package as a plain Python package.
    try:
        from catkin_pkg.package import InvalidPackage, parse_package
    except ImportError:
        return
    try:
        parse_package(file)
    except InvalidPackage as error:
        what = re2.sub(r"^Error\(s\) in package '[^']*':\s*", "", str(error)).strip()
        raise _BadPackage(f"{shown} is not valid: {what}") from error
    except AssertionError as error:
        # An AssertionError means an unknown format. It is replaced, because catkin_pkg's own message, to update
        # catkin_pkg, would not help.
        raise _BadPackage(f'{shown} is not valid: <package format="…"> has to be 1, 2 or 3') from error
    except (*UNREADABLE, ExpatError) as error:
        raise _BadPackage(f"{shown} is not valid: {_told(error)}") from error


def _told(error: Exception) -> str:
    return "it is nested too deeply" if isinstance(error, RecursionError | MemoryError) else str(error)


def launch_files(folder: Path) -> list[Path]:
    """Return the launch files below a folder, as paths inside it.

    A file counts as a launch file if it has a name like ``x.launch.py``, or is in a folder named `launch`.
    """
    every = (path for path in folder.rglob("*") if path.suffix in LAUNCH_LANGUAGES and path.is_file())
    named = (path for path in every if path.stem.endswith("launch") or path.parent.name == "launch")
    return sorted(path.relative_to(folder) for path in named)


def workspace_of(file: Path, beside: Iterable[Path]) -> Path | None:
    """Return the workspace that contains a launch file, else a workspace in the folders ``beside``; else None.

    Args:
        file: The launch file.
        beside: Folders that may contain a workspace with the course's usual name.
    """
    around = [folder for folder in file.resolve().parents if (folder / "src").is_dir()]
    candidates = [*around[:1], *(folder / WORKSPACE for folder in beside)]
    found = [folder for folder in candidates if any((folder / "src").glob("**/package.xml"))]
    return found[0] if found else None


def needed(packages: Iterable[Package], targets: Iterable[str]) -> list[Package]:
    """Return the targets and all packages on which they depend, even indirectly, in the order of ``packages``."""
    there = list(packages)
    dependencies: dict[str, set[str]] = {}
    for package in there:
        dependencies.setdefault(package.name, set()).update(package.dependencies)
    wanted, waiting = set[str](), list(targets)
    while waiting:
        name = waiting.pop()
        if name not in wanted:
            wanted.add(name)
            waiting += dependencies.get(name, ())
    return [package for package in there if package.name in wanted]


def sources_of(src: Path, packages: Iterable[Package]) -> SourceTree:
    """Return all sources that a build of these packages needs, each read once.

    Args:
        src: The folder of the packages.
        packages: The packages to build.

    Raises:
        BadSources: The sources are too large.
    """
    sources: list[Source] = []
    size = 0
    for folder in sorted(package.folder for package in packages):
        for source in read_sources(folder, folder.relative_to(src).as_posix(), MAX_BYTES):
            sources.append(source)
            size += len(source.data or b"")
            if len(sources) > MAX_FILES or size > MAX_BYTES:
                raise BadSources(
                    f"{src} contains more than {MAX_FILES} files or {MAX_BYTES // 10**6} MB: is it a workspace?"
                )
    return SourceTree(tuple(sources))


FORM = re2.compile(r"\s*([\w.-]+)\s*=\s*([\w.]+)\s*:\s*([\w.]+)\s*")
"""Matches an entry point: executable, module and function. Use it only for ASCII: re2 rejects lone surrogates."""


def console_scripts(tree: ast.AST) -> ast.List | None:
    """Return the list of ``console_scripts`` in the syntax tree of a setup.py; None if there is none."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Dict):
            for key, value in zip(node.keys, node.values, strict=True):
                named = isinstance(key, ast.Constant) and key.value == "console_scripts"
                if named and isinstance(value, ast.List):
                    return value
    return None


def is_entry_point(text: str) -> bool:
    """Return True if a text has the format of an entry point."""
    return text.isascii() and FORM.fullmatch(text) is not None


def objection(entry: object) -> str:
    """Return a sentence that says what is wrong with an invalid entry point, and what to write."""
    if isinstance(entry, str) and entry.count("=") > 1 and entry.count(":") > 1:
        return (
            f"Two entry points have run together: {entry!r}. A comma is missing between them: Python joins two strings "
            "with nothing between. Write a comma after each entry point, behind its closing quotation mark."
        )
    what = _what_is_wrong(entry) if isinstance(entry, str) else ""
    return f"{entry!r} is not an entry point. {what}Write: executable = package.module:function"


def _what_is_wrong(entry: str) -> str:
    """Return the mistake in an entry point, as a sentence with a space after it; empty if the mistake is unknown."""
    if len(entry.strip()) <= 1:
        return "It is a single letter: put the string into a list, in square brackets. "
    if "(" in entry:
        return "Leave out the parentheses: the function is named here and not called. "
    if "/" in entry:
        return "Write dots in the module instead of slashes, as in an import. "
    if "=" not in entry:
        return "The equals sign between the executable and the module is missing. "
    if ":" not in entry:
        return "The colon between the module and the function is missing. "
    return ""


def _strings(nodes: Iterable[ast.AST]) -> Iterator[str]:
    """Yield the values of those nodes of a syntax tree that are strings."""
    for node in nodes:
        if isinstance(node, ast.Constant) and isinstance(node.value, str):
            yield node.value


def _text(file: Path) -> str:
    try:
        return file.read_text(encoding="utf-8", errors="replace")
    except OSError:
        return ""
