"""What has changed since a commit, and which tests and exercises reach it."""

from __future__ import annotations

import json
import re
import subprocess
from collections import defaultdict
from dataclasses import asdict, dataclass
from itertools import islice, zip_longest
from pathlib import Path, PurePosixPath
from random import Random
from typing import TYPE_CHECKING

from tests import tiers
from tests.reach.graph import WHOLE, Files, Graph, Node
from tests.reach.pieces import REST, Source, read, texts
from tests.reach.roots import HOOK, exercises_of, is_source, listed, read_files, tests_of

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    Earlier = Callable[[str], str | None]

FOR_ALL = (
    "tests/conftest.py",
    "tests/tiers.py",
    "tests/reach/",
    "pyproject.toml",
    "environment/requirements/",
)
"""Beginnings of the paths of files that decide on each test."""
WORKSPACE = "solutions/ros2_ws/"
MOST, FEW = 120, 8
"""The most functions of tests, and exercises through the engine: nearly all reach a hub, such as a card's words."""
FAR = 1000
"""Files away, for a test that the graph leads to a change by the name of a method alone."""
_TOKEN = re.compile(r"[\w.]+")


class NoCommit(ValueError):
    """Git knows no such commit. The message is git's."""


@dataclass(frozen=True)
class Selection:
    """The tests that reach what has changed.

    Attributes:
        base: The commit since which it changed.
        files: The paths of the changed files.
        tests: The tests, as ``path::function``, with all their parameters.
        about: Exercises and labs: of each test whose parameters name one of these, these parameters.
        because: What decides on each test and has changed; empty if nothing of that kind has.
    """

    base: str
    files: tuple[str, ...]
    tests: frozenset[str]
    about: frozenset[str]
    because: str = ""

    def includes(self, test_id: str) -> bool:
        """Return whether a test, by its id in pytest, reaches a change."""
        name, _, parameters = test_id.partition("[")
        return (
            bool(self.because) or name in self.tests or not self.about.isdisjoint(_TOKEN.findall(parameters))
        )

    def may_be_in(self, path: str) -> bool:
        """Return whether a file may have a test that reaches a change."""
        return bool(self.because or self.about) or any(name.startswith(f"{path}::") for name in self.tests)

    def described(self) -> list[str]:
        """Return what was selected and why, a sentence a line."""
        if self.because:
            return [f"the short tier runs: {self.because} decides on each test"]
        about = f", and those about {' '.join(sorted(self.about))}" if self.about else ""
        return [
            f"changed files: {len(self.files)}; functions of tests that reach a change: {len(self.tests)}{about}"
        ]

    def as_json(self) -> str:
        """Return it as text for another process."""
        return json.dumps(
            {
                name: list(value) if isinstance(value, frozenset) else value
                for name, value in asdict(self).items()
            }
        )

    @classmethod
    def from_json(cls, text: str) -> Selection:
        """Return what ``as_json`` wrote."""
        told = json.loads(text)
        return cls(
            told["base"],
            tuple(told["files"]),
            frozenset(told["tests"]),
            frozenset(told["about"]),
            told["because"],
        )


def selection(root: Path, commit: str) -> Selection:
    """Select the tests of a repository that reach a change.

    Args:
        root: The repository.
        commit: The commit since which; empty for where this branch left ``origin/main``, or for the commit before.

    Raises:
        NoCommit: There is no such commit.
    """
    base = (
        _git(root, "rev-parse", "--verify", "--short", f"{commit}^{{commit}}")
        if commit
        else _usual_base(root)
    )
    changed = sorted(
        {
            *_git(root, "diff", "--name-only", "--no-renames", base).splitlines(),
            *_git(root, "ls-files", "--others", "--exclude-standard").splitlines(),
        }
    )

    def earlier(path: str) -> str | None:
        done = subprocess.run(
            ["git", "show", f"{base}:{path}"], cwd=root, capture_output=True, text=True, check=False
        )
        return done.stdout if done.returncode == 0 else None

    if whole := [path for path in changed if path.startswith(FOR_ALL)]:
        return Selection(base, tuple(changed), frozenset(), frozenset(), " ".join(whole))
    return reaching(root, read_files(root, listed(root)), changed, earlier, base)


def _git(root: Path, *words: str) -> str:
    done = subprocess.run(["git", *words], cwd=root, capture_output=True, text=True, check=False)
    if done.returncode:
        raise NoCommit(done.stderr.strip())
    return done.stdout.strip()


def _usual_base(root: Path) -> str:
    here = _git(root, "rev-parse", "HEAD")
    try:
        base = _git(root, "merge-base", "HEAD", "origin/main")
    except NoCommit:
        base = here
    return _git(root, "rev-parse", "--short", "HEAD~1" if base == here else base)


def reaching(root: Path, files: Files, changed: Iterable[str], earlier: Earlier, base: str = "") -> Selection:
    """Return the tests and exercises that reach changed files.

    Args:
        root: The repository.
        files: All of its files.
        changed: The paths of the changed ones.
        earlier: Returns a file's earlier text; None if there was no such file.
        base: The name of the commit with the earlier texts.
    """
    graph = Graph(files)
    tests, exercises = tests_of(graph), exercises_of(files)
    roots = [*tests, *exercises.values()]
    bits: dict[Node, int] = defaultdict(int)
    for place, node in enumerate(roots):
        bits[node] |= 1 << place
    reached = graph.reached(bits, unnamed=-1 << len(tests))  # the judge calls what an exercise defines
    ranked, about, through = list[list[Node]](), set[str](), set[Node]()
    for path in changed:
        if path.startswith("solutions/") or path.startswith("tests/evidence/"):
            about |= _about(path, exercises)
        if is_source(path):
            nodes = _changed_pieces(root, path, earlier)
        elif not path.startswith(("solutions/", "tests/evidence/")):
            nodes = {(path, REST)}
        else:
            continue
        mask = 0
        for node in nodes:
            mask |= reached.get(node, 0)
        found = {node for place, node in enumerate(roots) if mask >> place & 1} | _hooked(nodes, tests)
        if not mask and nodes and not path.startswith("docs/"):
            found |= _nearest(path, files, tests, reached, roots)
        through |= found.difference(tests)
        ranked.append(_by_distance(graph, path, found.intersection(tests)))
    nearest = dict.fromkeys(node for row in zip_longest(*ranked) for node in row if node)
    few = tiers.drawn([name for name, node in exercises.items() if node in through], FEW)
    about |= few | {name.partition(".")[0] for name in few}
    names = frozenset(f"{path}::{name}" for path, name in islice(nearest, MOST))
    return Selection(base, tuple(changed), names, frozenset(about))


def _by_distance(graph: Graph, path: str, tests: Iterable[Node]) -> list[Node]:
    """Sort tests by the number of files between them and a changed one; first those that have its name."""
    away, stem = graph.files_away(path), PurePosixPath(path).stem
    drawn = Random(tiers.seed())
    rank = {test: (away.get(test[0], FAR), stem not in test[0], drawn.random()) for test in sorted(tests)}
    return sorted(rank, key=rank.__getitem__)


def _changed_pieces(root: Path, path: str, earlier: Earlier) -> set[Node]:
    """The pieces of a file that do something else than before, also through what they import."""
    before = earlier(path)
    present = (root / path).read_text(encoding="utf-8") if (root / path).exists() else ""
    old, new = texts(before or ""), texts(present)
    names = {name for name in old.keys() | new.keys() if old.get(name) != new.get(name)}
    source, was = read(present), _imported(read(before or ""))
    moved = {alias for alias, meant in _imported(source).items() if alias in was and was[alias] != meant}
    for name, piece in source.pieces.items():
        if any(chain.partition(".")[0] in moved for chain in piece.chains):
            names.add(name)
    return {(path, name) for name in names}


def _imported(source: Source) -> dict[str, set[tuple[int, str]]]:
    found = defaultdict(set)
    for one in source.imports:
        found[one.alias].add((one.level, one.means))
    return found


def _about(path: str, exercises: dict[str, Node]) -> set[str]:
    """The exercises and labs whose files a path in ``solutions/`` or ``tests/evidence/`` is among."""
    parts = PurePosixPath(path).parts
    labs = {name.partition(".")[0] for name in exercises}
    if parts[0] == "tests":
        ids = {PurePosixPath(path).stem}
    elif len(parts) > 3 and parts[2] in labs:
        lab, name = parts[2], parts[3].partition(".")[0]
        if path.endswith(".py") and len(parts) == 4:
            return set()  # the graph knows whose it is
        ids = {f"{lab}.{name}"} & exercises.keys() or {one for one in exercises if one.startswith(f"{lab}.")}
    else:  # what the exercises of a chapter share; the programs of the workspace belong to the first chapter
        chapter = f"solutions/{parts[1]}/"
        ids = {
            one
            for one, (file, _) in exercises.items()
            if file.startswith(chapter) or path.startswith(WORKSPACE)
        }
    return ids | {one.partition(".")[0] for one in ids}


def _hooked(nodes: Iterable[Node], tests: Iterable[Node]) -> set[Node]:
    """The tests below a conftest of which a hook has changed: pytest calls it by its name."""
    folders = [
        path.removesuffix("conftest.py")
        for path, name in nodes
        if name.startswith(HOOK) and path.endswith("conftest.py")
    ]
    return {test for test in tests if test[0].startswith(tuple(folders))}


def _nearest(
    path: str, files: Files, tests: list[Node], reached: dict[Node, int], roots: list[Node]
) -> set[Node]:
    """For a change that nothing is seen to reach: what reaches anything in its file, its folder or the next one."""
    for beside in (path, *(f"{folder}/" for folder in list(PurePosixPath(path).parents)[:-1])):
        found = {test for test in tests if test[0].startswith(beside)}
        mask = 0
        for node, bits in reached.items():
            if node[0].startswith(beside) and node[0] in files.sources:
                mask |= bits
        found |= {node for place, node in enumerate(roots) if mask >> place & 1 and node[1] != WHOLE}
        if found:
            return found
    stem = PurePosixPath(path).stem
    return {test for test in tests if stem in PurePosixPath(test[0]).stem}
