"""Who reaches whom: from each test, and from each exercise, to the pieces of files that they may run or read.

A function is reached from what mentions it by name; a method, where its class and its name are both reached; a module,
also where a string names it, as a process is started; a file of data, where a string has its name. All roots are
followed at once: each piece has a set of those that reach it, a bit each, which grows until nothing changes.
"""

from __future__ import annotations

import re
from collections import defaultdict
from dataclasses import dataclass
from pathlib import PurePosixPath
from typing import TYPE_CHECKING

from tests.reach.pieces import MAIN, REST, Piece, Source

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from tests.reach.imports import Import

Node = tuple[str, str]
"""A file's path in the repository, and the name of a piece of it."""
COMMAND = "./course"
WHOLE = "*"
"""All pieces of a file."""
_PLAIN_BASE = re.compile(
    r"([\w.]*\.)?(object|Protocol|ABC|Exception|Generic|\w*Enum|NamedTuple|\w+Error|Struct)(\[.*\])?$"
)
"""A base class of others that calls no method of its subclasses."""
_MODULE = re.compile(r"\b(?:autograder|environment|benchmarks|tests)(?:\.\w+)+")


@dataclass(frozen=True)
class Files:
    """The files of a repository.

    Attributes:
        sources: The Python files by path.
        data: The texts of the other files by path; empty for one in which nothing names a module.
        modules: The paths of modules by name; a lab's exercise has its id.
    """

    sources: Mapping[str, Source]
    data: Mapping[str, str]
    modules: Mapping[str, str]


class Graph:
    """What each piece leads to."""

    def __init__(self, files: Files) -> None:
        self.files = files
        self.edges: dict[Node, set[Node]] = defaultdict(set)
        self.words: dict[Node, set[str]] = {}
        self.conditional: dict[str, set[tuple[Node, Node]]] = defaultdict(set)
        """By word: the pieces that it leads to where another one is reached, too."""
        self._names = {path: name for name, path in files.modules.items()}
        self._data_by_name: dict[str, list[str]] = defaultdict(list)
        self._data_by_stem: dict[str, list[str]] = defaultdict(list)
        for path in files.data:
            self._data_by_name[PurePosixPath(path).name].append(path)
            self._data_by_stem[path.removesuffix(PurePosixPath(path).suffix)].append(path)
        self._labs: dict[str, list[str]] = defaultdict(list)
        self._beside_tests: dict[str, list[str]] = defaultdict(list)
        for name, path in files.modules.items():
            if path.startswith("solutions/"):
                self._labs[name.partition(".")[0]].append(path)
            if path.startswith("tests/"):
                self._beside_tests[name.rpartition(".")[2]].append(path)
        self._aliases = {path: self._aliases_of(path) for path in files.sources}
        for path, source in files.sources.items():
            self._add(path, source)
        for path, text in files.data.items():
            for name in _MODULE.findall(text):
                self.edges[path, REST] |= {*self._named(name), *self._started(name)}

    def _aliases_of(self, path: str) -> dict[str, set[str]]:
        found: dict[str, set[str]] = defaultdict(set)
        for one in self.files.sources[path].imports:
            # A package may hand on, at its first use, what it imports for types.
            if not one.for_types or path.endswith("/__init__.py"):
                found[one.alias].add(self._full(path, one, one.means))
        return found

    def _full(self, path: str, one: Import, name: str) -> str:
        return one.full(name, self._names.get(path, ""), is_package=path.endswith("/__init__.py"))

    def _add(self, path: str, source: Source) -> None:
        rest = path, REST
        for one in source.imports:
            if one.at_start and not one.for_types:
                name = self._full(path, one, one.name)
                self.edges[rest] |= {(found, REST) for found, _ in self._named(name)}
        for name, piece in source.pieces.items():
            node = path, name
            self.edges[path, WHOLE].add(node)
            self.edges[node].add(rest)
            self.words[node] = piece.methods
            for chain in piece.chains:
                self.edges[node] |= set(self.mentioned(path, chain))
            for text in piece.strings:
                # An exercise that is one of a test's parameters is selected with this parameter.
                meant = self._meant(text)
                self.edges[node] |= {
                    one for one in meant if text not in piece.choices or not one[0].startswith("solutions/")
                }
            if any(chain.startswith("__file__") for chain in piece.chains):
                beside = self._data_by_stem.get(path.removesuffix(".py"), ())
                self.edges[node] |= {(other, REST) for other in beside}
            for module in piece.started:
                self.edges[node] |= set(self._started(module))
            if path.startswith(("tests/", "benchmarks/")):
                self.words[node] |= {f"{COMMAND} {word}" for word in piece.commands}
                if COMMAND in piece.strings or "installed_program" in piece.chains:
                    self.edges[node] |= set(self._started("autograder"))
            self._add_owner(path, name, piece)

    def _add_owner(self, path: str, name: str, piece: Piece) -> None:
        """A method needs its class; unless something else may call it, also its name."""
        owner, _, method = name.rpartition(".")
        if owner:
            self.edges[path, name].add((path, owner))
            if (method.startswith("__") and method.endswith("__")) or self._has_open_base(path, owner, set()):
                self.edges[path, owner].add((path, name))
            else:
                self.conditional[method].add(((path, owner), (path, name)))

    def _has_open_base(self, path: str, name: str, known: set[Node]) -> bool:
        """Whether a class has a base of others, which may call methods of it that nothing here mentions."""
        known.add((path, name))
        for base in self.files.sources[path].pieces.get(name, Piece()).bases:
            ours = [one for one in self.mentioned(path, base) if one[1] not in (REST, WHOLE)]
            if not ours and not _PLAIN_BASE.match(base):
                return True
            if any(one not in known and self._has_open_base(*one, known) for one in ours):
                return True
        return False

    def mentioned(self, path: str, chain: str) -> Iterator[Node]:
        """What a name in a file stands for."""
        head, _, rest = chain.partition(".")
        if head in self.files.sources[path].pieces:
            yield from self._asked(path, head)
        for full in self._aliases[path].get(head, ()):
            yield from self._named(f"{full}.{rest}".rstrip("."))

    def _asked(self, path: str, name: str) -> Iterator[Node]:
        command = self.files.sources[path].pieces[name].command
        if command:
            self.conditional[f"{COMMAND} {command}"].add(((path, REST), (path, name)))
        else:
            yield path, name

    def _started(self, module: str) -> Iterator[Node]:
        """What runs first when Python starts a module or a package."""
        for name in (module, f"{module}.__main__"):
            if path := self.files.modules.get(name):
                yield from ((path, piece) for piece in (REST, MAIN))

    def _named(self, full: str) -> Iterator[Node]:
        """The pieces behind a full name, such as ``autograder.verdict.Verdict``."""
        parts = full.split(".")
        for count in range(len(parts), 0, -1):
            name = ".".join(parts[:count])
            paths = [self.files.modules[name]] if name in self.files.modules else []
            if not paths and count == 1:
                paths = self._beside_tests.get(name, [])
            for path in paths:
                yield path, REST
                yield from self._in_module(path, parts[count:])
            if paths:
                return

    def _in_module(self, path: str, rest: list[str]) -> Iterator[Node]:
        if not rest or (rest[0].startswith("__") and rest[0] not in self.files.sources[path].pieces):
            yield path, WHOLE  # the module itself, or its __file__, which is started
        elif rest[0] in self.files.sources[path].pieces:
            yield from self._asked(path, rest[0])
        elif rest[0] in self._aliases[path]:
            for full in self._aliases[path][rest[0]]:
                if full != f"{self._names.get(path)}.{rest[0]}":
                    yield from self._named(".".join([full, *rest[1:]]))
        else:
            yield path, rest[0]  # which is no longer there

    def _meant(self, text: str) -> Iterator[Node]:
        """What a string names: a module, something in one, an exercise, a lab, a file of data."""
        name = text.replace(":", ".")
        if text in self._labs:
            yield from ((path, WHOLE) for path in self._labs[text])
        elif "." in name and name.partition(".")[0] in self.files.modules | self._labs.keys():
            yield from self._named(name)
        for path in self._data_by_name.get(PurePosixPath(text).name, ()) if "." in text else ():
            if path.endswith(text):
                yield path, REST

    def files_away(self, path: str) -> dict[str, int]:
        """Return for each file that leads to a file the number of files on the shortest way there."""
        back: dict[str, set[str]] = defaultdict(set)
        for (file, _), others in self.edges.items():
            for other, _ in others:
                back[other].add(file)
        away, ring = {path: 0}, {path}
        while ring:
            ring = {file for one in ring for file in back[one]} - away.keys()
            away |= dict.fromkeys(ring, max(away.values()) + 1)
        return away

    def reached(self, roots: Mapping[Node, int], unnamed: int = 0) -> dict[Node, int]:
        """Return for each piece the roots that reach it, as the bits of a number.

        Args:
            roots: The bits of each root.
            unnamed: The bits of roots whose classes are used by what they do not lead to: all of their methods count.
        """
        found: dict[Node, int] = defaultdict(int)
        by_word: dict[str, int] = defaultdict(lambda: unnamed)
        by_owner: dict[Node, list[tuple[str, Node]]] = defaultdict(list)
        for word, pairs in self.conditional.items():
            for owner, node in pairs:
                by_owner[owner].append((word, node))
        waiting: dict[Node, int] = dict(roots)
        while waiting:
            node = next(iter(waiting))  # the one that waits longest, so that much comes together meanwhile
            bits = waiting.pop(node)
            new = bits & ~found[node]
            if not new:
                continue
            found[node] |= new
            for other in self.edges.get(node, ()):
                waiting[other] = waiting.get(other, 0) | new
            for word, other in by_owner.get(node, ()):
                if both := new & by_word[word]:
                    waiting[other] = waiting.get(other, 0) | both
            for word in self.words.get(node, ()):
                fresh = new & ~by_word[word] if word in self.conditional else 0
                if fresh:
                    by_word[word] |= fresh
                    for owner, other in self.conditional[word]:
                        if both := fresh & found[owner]:
                            waiting[other] = waiting.get(other, 0) | both
        return found
