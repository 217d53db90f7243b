"""Makes the builds on which a grade depends: in a box, from the sources alone.

No submission shares a build with another submission, or with a second execution of itself. Otherwise the duration of a
build would reveal to a notebook what classmates have handed in, or that it runs for the second time. No submission can
change the build of another one, because no box can write to the folders with builds.

The only builds that submissions share are those of packages that the course itself publishes or makes. They are built
ahead, before any notebook needs them: the course's own programs (``solutions/ros2_ws``), and the packages that the
labs' texts and solutions make (``solutions/*/built_ahead.json``, written by ``python -m tests.measure built_ahead``).
If a package is missing there, or has changed since, each submission builds it for itself, which only costs time.

Students write the same three lines of an interface with different comments and spaces. So that they can all use the
build that was made ahead, the sources of packages that only define interfaces are simplified. A text is simplified only
if its meaning certainly stays the same; otherwise the package is built separately.
"""

from __future__ import annotations

import contextlib
import functools
import threading
from dataclasses import replace
from itertools import pairwise
from pathlib import PurePosixPath
from typing import TYPE_CHECKING
from xml.etree import ElementTree

import msgspec
import re2

from autograder import course
from autograder.messages.workspace_messages import Source
from autograder.safe_files import HeldFolder
from autograder.workspaces.builds import build_artifacts, build_cache
from autograder.workspaces.builds.cached_builds import Builds, BuildTookTooLong, file_state
from autograder.workspaces.builds.colcon_build import describe_workspace, failed_build
from autograder.workspaces.packages import DEFINITIONS, FOR_READERS, UNREADABLE
from autograder.workspaces.program_plans import course_interfaces, reference_workspace
from autograder.workspaces.program_preparation import COURSE
from autograder.workspaces.sources import SourceTree

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from autograder.workspaces.builds.colcon_build import Build
    from autograder.workspaces.jobs import BuildJob, Jobs


ROOM = 32_000_000
"""The maximum size in bytes of all builds of a notebook. An interface package takes two million, a Python package
300,000.
"""


class GradedBuilds(Builds):
    """The builds for one execution of a submission.

    Args:
        folder: The folder for the builds of this execution. Only the grader can write to it.
        jobs: Runs colcon and the built programs.
        ahead: The folder of builds made in advance; None if nothing is shared. If it is ``folder``, they are made.
        room: The maximum size in bytes of all builds that the execution uses, including builds made in advance.
    """

    def __init__(self, folder: Path, jobs: Jobs, ahead: Path | None = None, room: int = ROOM) -> None:
        super().__init__(folder, jobs, room)
        self._ahead = ahead
        self._paid: set[str] = set()

    def _keyed(self, job: BuildJob, *words: str) -> BuildJob:
        # If the packages define interfaces, hide the course's interfaces from the build.
        hides = any(source.path.endswith(DEFINITIONS) for source in job.tree.sources)
        found = [] if hides else [f"{path} {file_state(str(path))}" for path in course_interfaces()]
        return super()._keyed(replace(job, hidden=course_interfaces() if hides else ()), *found, *words)

    def _entry(self, found: Build, job: BuildJob, folder: Path | None = None) -> Build:
        """Return the build, or a failed build if all builds, including those made in advance, exceed the size limit."""
        names = {package.name for package in job.packages}
        interfaces = all(p.holds_only_interfaces for p in found.packages if p.name in names)
        shared = self._keyed(replace(job, tree=simplified(job.tree))) if interfaces else job
        if self._ahead and (self._ahead == self._folder or build_cache.is_complete(shared.key, self._ahead)):
            job, folder = shared, self._ahead
        made = super()._entry(found, job, folder)
        if made.install is None or job.key in self._paid:
            return made
        try:
            build_artifacts.check_room(size := build_cache.size_of(made.install), self._room)
        except build_artifacts.BadArtifacts as error:
            return failed_build(found, f"error: {error}")
        self._room -= size
        self._paid.add(job.key)
        return made


BUILT_AHEAD = "built_ahead.json"
"""The name of a chapter's file with the packages to build ahead."""
PackageFiles = dict[str, str | None]
"""Packages that are built together: the text of each file by its path relative to ``src``; None for a folder."""
_ROOM_AHEAD = 1_000_000_000
_done: set[Path] = set()


def packages_to_build_ahead(root: Path) -> list[PackageFiles]:
    """Return the packages in the files ``built_ahead.json`` of all chapters."""
    found: list[PackageFiles] = []
    for file in sorted((root / "solutions").glob(f"*/{BUILT_AHEAD}")):
        found += msgspec.json.decode(file.read_bytes(), type=list[PackageFiles])
    return found


def build_ahead(folder: Path, jobs: Jobs) -> None:
    """Build every shared package that the cache lacks. A second call for the same folder does nothing.

    Args:
        folder: The folder for these builds; see :func:`autograder.workspaces.builds.build_cache.graders_root`.
        jobs: Runs colcon.
    """
    if folder in _done:
        return
    builds = GradedBuilds(folder, jobs, folder, room=_ROOM_AHEAD)
    every: list[Callable[[], object]] = [
        functools.partial(_build, builds, files) for files in packages_to_build_ahead(course.root())
    ]
    if (own := reference_workspace()).is_dir():
        every.append(lambda: builds.build(describe_workspace(own), None, name=COURSE))
    # Begin with a different package in each thread, so that notebooks that start at the same time share the work.
    first = threading.get_native_id() % max(1, len(every))
    for build in (*every[first:], *every[:first]):
        # If a build takes too long, skip it: each submission with this package then builds it for itself.
        with contextlib.suppress(BuildTookTooLong):
            build()
    _done.add(folder)


def _build(builds: GradedBuilds, files: PackageFiles) -> object:
    """Build packages that the course has recorded."""
    sources = (Source(path, None if text is None else text.encode()) for path, text in files.items())
    with HeldFolder("autograder-ahead-") as folder:
        SourceTree(tuple(sources)).write(folder.path / "src")
        return builds.build(describe_workspace(folder.path), None)


MAX_SIMPLIFIED = 50_000
"""The maximum size in bytes of sources to be simplified; a student's sources have about a thousand bytes.

Larger sources are built as they are, because simplifying takes quadratic time.
"""
_FOR_PEOPLE = {"description", "maintainer", "author", "license", "url"}
"""Elements of package.xml that only people read. They are removed, or replaced by a fixed text if they are required."""


def simplified(tree: SourceTree) -> SourceTree:
    """Return the sources of interface packages, simplified so that sources with the same meaning are equal."""
    if sum(len(source.data or b"") for source in tree.sources) > MAX_SIMPLIFIED:
        return tree
    return SourceTree(tuple(msgspec.structs.replace(source, data=_simple(source)) for source in tree.sources))


def _simple(source: Source) -> bytes | None:
    path = PurePosixPath(source.path)
    if source.data is None or path.name in FOR_READERS:
        return None if source.data is None else b""
    rewrite = _simple_definition if path.suffix in DEFINITIONS else _SIMPLE_FORMS.get(path.name)
    try:
        return rewrite(source.data.decode()).encode() if rewrite else source.data
    except UnicodeDecodeError:
        return source.data


def _simple_definition(text: str) -> str:
    """Return an interface definition without comments and needless spaces. Unusual lines stay unchanged.

    Unusual lines have, for example, a space after ``---`` or before a type, or spaces that are not ASCII. They are kept
    because rosidl rejects them, and a simplified line would be accepted.
    """
    lines = []
    for line in text.splitlines():
        code = line.partition("#")[0]
        if re2.fullmatch(r"[!-~]+([ \t]+[!-~]+)+[ \t]*", code) and not re2.search("[\"']", line):
            lines.append(" ".join(code.split()))
        elif code.strip(" \t"):
            lines.append(line)
    return "\n".join(lines) + "\n"


def _simple_cmake(text: str) -> str:
    """Return a CMakeLists.txt without comments and needless spaces; unchanged if it has more than plain commands.

    For example, it is unchanged if it has bracket arguments or bracket comments, escapes, or quoted texts of several
    lines (cmake-language(7)).
    """
    if re2.search(r"\\|\[=*\[", text) or any(line.count('"') % 2 for line in text.splitlines()):
        return text
    found = list(re2.finditer(r'"[^"\n]*"|#[^\n]*|[()]|\n|[^\s()"#]+', text))
    for one, other in pairwise(found):
        if one.end() == other.start() and not any(re2.match(r"[()#\n]", word[0]) for word in (one, other)):
            return text  # a quoted text inside a word
    words = [word[0] for word in found if not word[0].startswith("#")]
    out, depth = "", 0
    for word in words:
        if word == "\n" and depth > 0:
            continue
        if word == ")":
            depth -= 1
            out = out.rstrip(" ") + ")"
        elif word == "(":
            depth += 1
            out = out.rstrip(" ") + "("
        elif word == "\n":
            out = out.rstrip(" \n") + "\n"
        else:
            out += ("" if out.endswith(("(", "\n", " ")) or not out else " ") + word
    return out.strip() + "\n"


def _simple_package_xml(text: str) -> str:
    """Return a package.xml with only the elements that a build reads, in a fixed order."""
    try:
        root = ElementTree.fromstring(text)
        return _simple_elements(root) or text
    except UNREADABLE:
        return text


def _simple_elements(root: ElementTree.Element) -> str:
    """Return the simplified text of a package.xml; empty if an element other than ``export`` contains elements."""
    kept = [element for element in root if element.tag not in _FOR_PEOPLE]
    if any(len(element) for element in kept if element.tag != "export"):
        return ""
    lines = sorted(_element(element) for element in kept)
    for_people = '<description>-</description><maintainer email="nobody@example.com">-</maintainer><license>-</license>'
    attributes = "".join(f' {name}="{value}"' for name, value in sorted(root.attrib.items()))
    return "\n".join([f"<package{attributes}>", for_people, *lines, "</package>"]) + "\n"


def _element(element: ElementTree.Element) -> str:
    element.tail = None
    for part in element.iter():
        part.text = part.text.strip() if part.text else None
        part.tail = None
    return ElementTree.tostring(element, encoding="unicode")


_SIMPLE_FORMS = {"CMakeLists.txt": _simple_cmake, "package.xml": _simple_package_xml}
