"""The size of each part of the code, held by ceilings that only fall.

``tests/size_ceilings.toml`` contains the ceilings. ``python -m tests.size`` lowers them to the present sizes, and
never raises one; only if the file contains no ceiling, it sets all anew. ``python -m tests.size --since COMMIT`` lists
the parts and files that have grown or shrunk, and changes nothing. If a change is worth more lines, say in
docs/decisions.md for whom, and what would end it if that is known. Name that entry in a table ``[[raised]]`` of the
ceilings file::

    [[raised]]
    part = "autograder/kit"
    logic = 40
    entry = "2026-12-01: services with arrays"

Counted are the Python files that Git has, without the bank's answers and the tests. A table of data, that is a list of
rows at the top of a module, is not counted: a row more is not a program that is longer.
"""

from __future__ import annotations

import argparse
import ast
import functools
import io
import subprocess
import tarfile
import tokenize
import tomllib
from collections import Counter
from dataclasses import dataclass
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
CEILINGS = ROOT / "tests" / "size_ceilings.toml"
DECISIONS = ROOT / "docs" / "decisions.md"
COUNTED = ("autograder", "course_runtime", "environment", "solutions")
WORDS = {"logic": "logic lines", "public": "public names"}
TOO_HIGH = {"logic": 10, "public": 3}
"""By how much a ceiling may be above the size before it has to be lowered, or one percent, if that is more."""
_IN_ROWS = (
    *(ast.expr_context, ast.Constant, ast.Tuple, ast.List, ast.Set, ast.Dict, ast.Name, ast.Attribute),
    *(ast.Call, ast.keyword, ast.Starred, ast.UnaryOp, ast.USub),
)
"""What a row of data may contain. Everything else, such as a condition or a function, is a program."""


@dataclass(frozen=True)
class Module:
    """What counts in a file.

    Attributes:
        logic: The number of lines that are neither blank nor comment, docstring, import or data.
        names: The names of the functions, classes and methods, with repetitions.
        foreign: The names with an underscore that the file takes from elsewhere.
    """

    logic: int
    names: tuple[str, ...]
    foreign: frozenset[str]


@functools.cache
def module_of(text: str) -> Module:
    """Return what counts in the text of a Python file."""
    tree = ast.parse(text)
    nodes = list(ast.walk(tree))
    ignored = {number for number, line in enumerate(text.splitlines(), 1) if not line.strip()}
    lines = iter(text.splitlines(keepends=True))
    for token in tokenize.generate_tokens(lambda: next(lines, "")):
        if token.type == tokenize.COMMENT and token.line.lstrip().startswith("#"):
            ignored.add(token.start[0])
    for node in [*nodes, *tree.body]:
        if isinstance(node, ast.Import | ast.ImportFrom) or (node in tree.body and _is_data(node)):
            ignored.update(_lines(node))
        body = getattr(node, "body", None)
        for before, statement in zip([None, *body], body, strict=False) if isinstance(body, list) else ():
            if _is_text(statement) and (before is None or isinstance(before, ast.Assign | ast.AnnAssign)):
                ignored.update(_lines(statement))
    kinds = (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)
    imports = [node for node in nodes if isinstance(node, ast.Import | ast.ImportFrom)]
    imported = {alias.asname or alias.name for node in imports for alias in node.names}
    of_modules = {
        node.attr
        for node in nodes
        if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name) and node.value.id in imported
    }
    return Module(
        logic=len(set(range(1, len(text.splitlines()) + 1)) - ignored),
        names=tuple(node.name for node in nodes if isinstance(node, kinds)),
        foreign=frozenset(name for name in imported | of_modules if name.startswith("_")),
    )


def _lines(node: Any) -> range:
    return range(node.lineno, node.end_lineno + 1)


def _is_text(node: ast.stmt) -> bool:
    return (
        isinstance(node, ast.Expr)
        and isinstance(node.value, ast.Constant)
        and isinstance(node.value.value, str)
    )


def _is_data(node: ast.AST) -> bool:
    """Return True for an assignment of a list, tuple, set or dict that contains rows of data and no program."""
    value = node.value if isinstance(node, ast.Assign | ast.AnnAssign) else None
    return isinstance(value, ast.Tuple | ast.List | ast.Set | ast.Dict) and all(
        isinstance(inner, _IN_ROWS) for inner in ast.walk(value)
    )


def part_of(path: Path) -> str:
    """Return the part of a file: a folder of ``autograder`` or ``course_runtime``, or the files beside the folders."""
    return "/".join(path.parts[: 1 if path.parts[0] == "solutions" else 2][: len(path.parts) - 1])


def sizes(files: dict[Path, Module]) -> dict[str, Counter[str]]:
    """Return the logic lines and public names of each part.

    A name is public if it begins with a letter, or if another file uses it.
    """
    users = Counter(name for module in files.values() for name in module.foreign)
    parts: dict[str, Counter[str]] = {}
    for path, module in files.items():
        public = [
            name for name in module.names if name[0].isalpha() or users[name] > (name in module.foreign)
        ]
        size = parts.setdefault(part_of(path), Counter(logic=0, public=0))
        size.update(logic=module.logic, public=len(public))
    return parts


def files_of_the_course() -> dict[Path, Module]:
    """Return the counted files, with paths relative to the course."""
    listed = subprocess.run(
        ["git", "ls-files", "--cached", "--others", "--exclude-standard", "--", *COUNTED],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=True,
    )
    paths = [Path(line) for line in listed.stdout.splitlines() if line.endswith(".py")]
    return {
        path: module_of((ROOT / path).read_text(encoding="utf-8"))
        for path in paths
        if (ROOT / path).exists() and _counts(path)
    }


def files_at(commit: str) -> dict[Path, Module]:
    """Return the counted files of a commit, with paths relative to the course.

    Raises:
        subprocess.CalledProcessError: Git does not know the commit.
    """
    archive = subprocess.run(
        ["git", "archive", commit, "--", *COUNTED], cwd=ROOT, stdout=subprocess.PIPE, check=True
    )
    with tarfile.open(fileobj=io.BytesIO(archive.stdout)) as tar:
        texts = {Path(one.name): tar.extractfile(one) for one in tar if one.name.endswith(".py")}
        return {
            path: module_of(text.read().decode()) for path, text in texts.items() if text and _counts(path)
        }


def _counts(path: Path) -> bool:
    return not any(part.endswith(".answers") for part in path.parts)


def growth(before: dict[Path, Module], now: dict[Path, Module]) -> list[str]:
    """Return a line for each part whose logic lines have changed, and below it one for each file, the largest first."""
    lines = []
    then, present = sizes(before), sizes(now)
    for part in sorted({*then, *present}):
        inside = {path for path in {*before, *now} if part_of(path) == part}
        more = {
            path: (now[path].logic if path in now else 0) - (before[path].logic if path in before else 0)
            for path in inside
        }
        if any(more.values()):
            was, size = (of.get(part, Counter())["logic"] for of in (then, present))
            lines.append(f"{part}: {was} logic lines before, {size} now ({size - was:+})")
            changed = sorted((path for path in inside if more[path]), key=lambda path: (-more[path], path))
            lines += [f"    {more[path]:+5} {path}" for path in changed]
    return lines


def wrong_ceilings(parts: dict[str, Counter[str]], data: dict[str, Any], decisions: str) -> list[str]:
    """Return a sentence for each ceiling that is too low or too high, or was raised without an entry."""
    wrong = [
        f"the entry {one['entry']!r}, for which {one['part']} was raised, is not in docs/decisions.md"
        for one in data.get("raised", ())
        if one["entry"] not in decisions or not one["entry"][:10].replace("-", "").isdigit()
    ]
    wrong += [f"{part} does not exist: remove its line" for part in data["ceilings"].keys() - parts.keys()]
    for part, size in sorted(parts.items()):
        for kind, words in WORDS.items():
            ceiling = data["ceilings"].get(part, {}).get(kind, 0) + _raised(data, part, kind)
            if size[kind] > ceiling:
                wrong.append(f"{part} has {size[kind]} {words}, and {ceiling} are allowed")
            elif ceiling - size[kind] > max(TOO_HIGH[kind], ceiling / 100):
                wrong.append(f"{part} has only {size[kind]} {words}: lower its ceiling of {ceiling}")
    return wrong


def _raised(data: dict[str, Any], part: str, kind: str) -> int:
    return sum(one.get(kind, 0) for one in data.get("raised", ()) if one["part"] == part)


def lowered(parts: dict[str, Counter[str]], data: dict[str, Any]) -> str:
    """Return the text of the ceilings file with each ceiling, as raised, at the present size, if that is lower."""
    lines = []
    for part, size in sorted(parts.items()):
        old = data["ceilings"].get(part, {}) if data["ceilings"] else size
        numbers = (
            f"{kind} = {min(size[kind] - _raised(data, part, kind), old.get(kind, 0))}" for kind in WORDS
        )
        lines.append(f'"{part}" = {{ {", ".join(numbers)} }}')
    for one in data.get("raised", ()):
        more = (f"{kind} = {one[kind]}" for kind in WORDS if kind in one)
        lines += ["", "[[raised]]", f'part = "{one["part"]}"', *more, f'entry = "{one["entry"]}"']
    return "\n".join(
        [
            "# The most logic lines and public names of each part of the code. tests/size.py explains this file.",
            f'since = "{data["since"]}"',
            "",
            "[ceilings]",
            *lines,
            "",
        ]
    )


def main() -> None:
    """Lower the ceilings, and print the sizes; or list what has grown since a commit."""
    parser = argparse.ArgumentParser(prog="python -m tests.size", description=main.__doc__)
    parser.add_argument("--since", metavar="COMMIT", help="list what has grown or shrunk since this commit")
    since = parser.parse_args().since
    if since is not None:
        print(*growth(files_at(since), files_of_the_course()), sep="\n")
        return
    found = sizes(files_of_the_course())
    CEILINGS.write_text(lowered(found, tomllib.loads(CEILINGS.read_text())))
    for part, size in sorted(found.items()):
        print(f"{part:28} {size['logic']:6} logic lines {size['public']:5} public names")


if __name__ == "__main__":
    main()
