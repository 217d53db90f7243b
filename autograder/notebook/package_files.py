"""Adds lines to the files of a package. A cell may call these functions any number of times, in any order.

If a cell wrote the whole ``setup.py``, running it again would remove the lines that later labs have added. So these
functions change only a part of a file: an entry point replaces the earlier one with the same name, and no line is added
twice.
"""

from __future__ import annotations

import ast
import io
import re  # noqa: TID251  (in the student's own kernel)
import tokenize
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from autograder.workspaces import packages
from autograder.workspaces.packages import UNREADABLE

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

PACKAGE = "my_robot_pkg"
_ADDED = "# by add_data_files"
"""The comment after each entry of data_files that this module has added."""
_DEFINITIONS = re.compile(r"rosidl_generate_interfaces\s*\(\s*\$\{PROJECT_NAME\}[^)]*")


@dataclass(frozen=True)
class _Element:
    """An element of a list in setup.py: an entry point, or a pair in data_files.

    Attributes:
        source: The text of the element in setup.py, which is written back unchanged.
        text: The value of the element, such as ``talker = my_robot_pkg.talker:main``; the same as ``source`` if only
            running setup.py would give the value.
        above: The comments on the lines above the element.
        behind: The comment at the end of the element's line.
    """

    source: str
    text: str
    above: tuple[str, ...] = ()
    behind: str = ""


def add_entry_points(workspace: str | Path, entries: Iterable[str], package: str = PACKAGE) -> str:
    """Add entry points to a package's ``setup.py``. They replace entry points with the same executable or function.

    Args:
        workspace: The workspace folder, which contains ``src``.
        entries: Entry points, each of the form ``executable = package.module:function``.

    Returns:
        A text for the student: the executables that the package has now, with a warning for each module without a
        package; or, if nothing was changed, what the student has to do.
    """
    setup = Path(workspace) / "src" / package / "setup.py"
    wanted = list(entries)
    for entry in wanted:
        if not isinstance(entry, str) or not packages.is_entry_point(entry):
            return packages.objection(entry)
    try:
        text, tree = _read(setup)
        programs = packages.console_scripts(tree)
    except _CannotUse as error:
        return str(error)
    if programs is None:
        listed = ", ".join(f'"{entry}"' for entry in wanted)
        return f'{setup} has no list of console_scripts. Add: entry_points={{"console_scripts": [{listed}]}},'
    present, last_comments = _elements(text, tree, programs)
    merged = list(present)
    for entry in wanted:
        same = {n for n, old in enumerate(merged) if set(_parts(old.text)) & set(_parts(entry))}
        index = min(same, default=len(merged))
        kept = next((old for old in merged if " ".join(old.text.split()) == " ".join(entry.split())), None)
        # The comments above a replaced entry are the student's, so they move to the new entry.
        above = tuple(comment for n in sorted(same) for comment in merged[n].above)
        merged = [old for n, old in enumerate(merged) if n not in same]
        merged.insert(index, replace(kept or _written(entry), above=above))
    if not merged:
        return f"{package} has no executable yet."
    if merged != present:
        setup.write_text(_with_list(text, programs, merged, last_comments), encoding="utf-8")
    return "\n".join(
        [
            f"Executables of {package}:",
            *(f"  {element.text}" for element in merged),
            *_without_package(wanted, package),
        ]
    )


def add_data_files(
    workspace: str | Path, pairs: Iterable[tuple[str, Sequence[str]]], package: str = PACKAGE
) -> str:
    """Make a package's ``setup.py`` install files. They replace the files that an earlier call has added.

    Args:
        workspace: The workspace folder, which contains ``src``.
        pairs: Pairs of a folder, below the package's folder in ``install``, and the files that are installed into it.

    Returns:
        A text for the student: the pairs that ``setup.py`` installs now, or what the student has to do.
    """
    setup = Path(workspace) / "src" / package / "setup.py"
    wanted = list(pairs)
    for pair in wanted:
        if not _is_data_files(pair):
            return (
                f"{pair!r} is not a pair of a folder and a list of files. Write a pair in parentheses, "
                "the folder first, and square brackets around the files, even for a single file."
            )
    try:
        text, tree = _read(setup)
    except _CannotUse as error:
        return str(error)
    listed = _listed_data_files(tree)
    if listed is None:
        return f"{setup} has no list of data_files. Add: data_files={wanted!r},"
    elements, last_comments = _elements(text, tree, listed)
    # Only entries with this mark come from an earlier call; all others are the student's own.
    kept = [element for element in elements if element.behind != _ADDED]
    merged = [*kept, *(_Element(repr(pair), repr(pair), behind=_ADDED) for pair in wanted)]
    if merged != elements:
        setup.write_text(_with_list(text, listed, merged, last_comments), encoding="utf-8")
    return "\n".join([f"{package} installs:", *(f"  {' '.join(one.source.split())}" for one in merged)])


def _is_data_files(pair: object) -> bool:
    match pair:
        case (str(), [*files]):
            return all(isinstance(file, str) for file in files)
    return False


def _listed_data_files(tree: ast.Module) -> ast.List | None:
    """Return the list that a setup.py passes as ``data_files``; None if there is none."""
    values = (
        node.value for node in ast.walk(tree) if isinstance(node, ast.keyword) and node.arg == "data_files"
    )
    return next((value for value in values if isinstance(value, ast.List)), None)


class _CannotUse(ValueError):
    """A setup.py cannot be changed. The message says what the student has to do."""


def _read(setup: Path) -> tuple[str, ast.Module]:
    """Return the text of a setup.py, and its syntax tree.

    Raises:
        _CannotUse: The file does not exist or cannot be read.
    """
    try:
        text = setup.read_text(encoding="utf-8")
        return text, ast.parse(text)
    except FileNotFoundError:
        raise _CannotUse(f"There is no {setup}. First make the package, as in Lab 1.1.") from None
    except UNREADABLE as error:
        where = f"line {error.lineno}: {error.msg}" if isinstance(error, SyntaxError) else error
        raise _CannotUse(f"{setup} cannot be read: {where}.") from None


def add_dependencies(workspace: str | Path, names: Iterable[str], package: str = PACKAGE) -> str:
    """Add missing ``<depend>`` lines to the ``package.xml`` of a package.

    Args:
        workspace: The workspace folder, which contains ``src``.
        names: The names of the packages on which the package depends.

    Returns:
        A text for the student: the dependencies that the package has now, or what the student has to do.
    """
    manifest = Path(workspace) / "src" / package / "package.xml"
    if not manifest.is_file():
        return f"There is no {manifest}. First make the package {package}."
    text = manifest.read_text(encoding="utf-8")
    for name in names:
        if not re.search(rf"<(?:exec_|build_)?depend>\s*{re.escape(name)}\s*<", text):
            following = re.search(r"\n[ \t]*(?=<(?:test_depend|member_of_group|export)\b|</package>)", text)
            at = following.start() if following else len(text)
            text = f"{text[:at]}\n  <depend>{name}</depend>{text[at:]}"
    manifest.write_text(text, encoding="utf-8")
    found = re.findall(r"<(?:exec_|build_)?depend>\s*(\S+?)\s*<", text)
    return f"Dependencies of {package}: {', '.join(dict.fromkeys(found))}"


def add_definition(workspace: str | Path, package: str, definition: str, needs: Iterable[str] = ()) -> str:
    """Add a definition file to the interfaces that a package's ``CMakeLists.txt`` generates code from.

    Args:
        workspace: The workspace folder, which contains ``src``.
        definition: The path of the definition file in the package, such as ``action/Fibonacci.action``.
        needs: The packages on which the generated code depends.

    Returns:
        A text for the student: the definitions from which the package now generates code, or what the student has to
        do.
    """
    folder = Path(workspace) / "src" / package
    file, lists = folder / definition, folder / "CMakeLists.txt"
    # Every service and action definition has this separator, so a file without it is not finished.
    if not file.is_file() or "---" not in file.read_text(encoding="utf-8"):
        return f"{definition} is not written yet."
    text = lists.read_text(encoding="utf-8") if lists.is_file() else ""
    command = _DEFINITIONS.search(text)
    if command is None:
        return f"{lists} generates nothing yet: it has no rosidl_generate_interfaces."
    if f'"{definition}"' not in command[0]:
        text = f'{text[: command.end()].rstrip()} "{definition}"{text[command.end() :]}'
        lists.write_text(text, encoding="utf-8")
    generated = ", ".join(re.findall(r'"([^"]+)"', "".join(_DEFINITIONS.findall(text))))
    return f"{package} generates: {generated}\n{add_dependencies(workspace, needs, package)}"


def _without_package(entries: list[str], package: str) -> list[str]:
    """Return a warning for each module that is named without its package."""
    modules = [(entry, _parts(entry)[1].partition(":")[0]) for entry in entries]
    return [
        f"Careful: in {entry!r} the module has no package in front of it, so Python will not find it. "
        f"Write {package}.{module}."
        for entry, module in modules
        if "." not in module
    ]


def _parts(entry: str) -> tuple[str, str]:
    """Return the executable of an entry point, and the function that it starts."""
    name, _, target = "".join(entry.split()).partition("=")
    return name, target


def _written(entry: str) -> _Element:
    text = " ".join(entry.split())
    return _Element(f'"{text}"', text)


def _elements(text: str, tree: ast.Module, programs: ast.List) -> tuple[list[_Element], list[str]]:
    """Return the elements of a list in setup.py, and the comments after the list's last element."""
    names = {
        target.id: node.value.value
        for node in tree.body
        if isinstance(node, ast.Assign) and isinstance(node.value, ast.Constant)
        for target in node.targets
        if isinstance(target, ast.Name)
    }
    comments = _comments(text, programs)
    last_on_its_line = {item.end_lineno or item.lineno: item for item in programs.elts}
    found, reached = [], programs.lineno
    for item in programs.elts:
        source = ast.get_source_segment(text, item) or ast.unparse(item)
        end = item.end_lineno or item.lineno
        above = tuple(comments[line] for line in range(reached, item.lineno) if line in comments)
        behind = comments.get(end, "") if last_on_its_line[end] is item else ""
        found.append(_Element(source, _value(item, names) or source, above, behind))
        reached = end + 1
    return found, [comment for line, comment in comments.items() if line >= reached]


def _comments(text: str, programs: ast.List) -> dict[int, str]:
    """Return the comments inside a list in setup.py, each with its line number (counted from 1) as the key."""
    first, last = programs.lineno, programs.end_lineno or programs.lineno
    return {
        token.start[0]: token.string
        for token in tokenize.generate_tokens(io.StringIO(text).readline)
        if token.type == tokenize.COMMENT and first <= token.start[0] < last
    }


def _value(node: ast.expr, names: Mapping[str, object]) -> str | None:
    """Return the value of an expression as text; None if more than constants and the given names is needed."""
    match node:
        case ast.Constant(value=value):
            return str(value)
        case ast.Name(id=name):
            return str(names[name]) if name in names else None
        case ast.FormattedValue(value=inner, conversion=-1, format_spec=None):
            return _value(inner, names)
        case ast.BinOp(left=left, op=ast.Add(), right=right):
            parts = [_value(left, names), _value(right, names)]
        case ast.JoinedStr(values=values):
            parts = [_value(part, names) for part in values]
        case _:
            return None
    return None if None in parts else "".join(part for part in parts if part)


def _with_list(text: str, programs: ast.List, elements: list[_Element], last_comments: list[str]) -> str:
    """Return the text of setup.py with these elements in the list, followed by the comments."""
    lines = text.encode().split(b"\n")
    first, last = programs.lineno - 1, (programs.end_lineno or programs.lineno) - 1
    before = b"\n".join([*lines[:first], lines[first][: programs.col_offset]]).decode()
    after = b"\n".join([lines[last][programs.end_col_offset :], *lines[last + 1 :]]).decode()
    indent = " " * (len(lines[first]) - len(lines[first].lstrip()))
    written = [line for element in elements for line in _lines(element)]
    inside = "".join(f"{indent}    {line}\n" for line in [*written, *last_comments])
    return f"{before}[\n{inside}{indent}]{after}"


def _lines(element: _Element) -> list[str]:
    """Return the lines that an element takes in setup.py: its comments, then the element."""
    return [*element.above, f"{element.source},{'  ' * bool(element.behind)}{element.behind}"]
