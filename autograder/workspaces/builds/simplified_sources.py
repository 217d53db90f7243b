"""Simplifies the sources of interface packages, so that packages with the same meaning have the same build.

A text is simplified only if its meaning certainly stays the same; otherwise it stays as it is.
"""

from __future__ import annotations

from itertools import pairwise
from pathlib import PurePosixPath
from typing import TYPE_CHECKING
from xml.etree import ElementTree

import msgspec
import re2

from autograder.workspaces.packages import DEFINITIONS, FOR_READERS, UNREADABLE
from autograder.workspaces.sources import SourceTree

if TYPE_CHECKING:
    from autograder.messages.workspace_messages import Source

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
