"""The bank of attacks: one file an attack, data for whoever grades it.

A file of `bank/` is what a student hands in. Its first comment is TOML:

    # family = "forging"                     one of FAMILIES
    # tries = "What it tries, in a sentence or two."
    # could_earn = "What it would earn, or do, without the defence."
    # undefended = "What happened when it was run without that defence."

and, where they differ from the usual:

    # assignment = "lab_1_3"                 which notebook it hands in; lab_1_2 otherwise
    # earned = { "lab_1_2.talker" = 3 }      points that are honestly earned; none otherwise
    # at_most = true                         it may earn less, where the machine is busy
    # boxed_only = true                      it would harm this machine without a box
    # refused = true                         the instructor is to be told of it; `grade` ends with code 2 then
    # says = "SEARCHED by me"                what its pages or its evidence must have, or else it was never run

In a file of `bank/*/*.py` cells follow:

    # %% solution NAME      what stands in the solution cell of that name
    # %% right NAME         the master's own solution in it
    # %% behind NAME        a cell of the student's own, right behind that solution cell
    # %% extra              a cell of the student's own in front of the next solution cell (or at the end)

What is not mentioned stays as it was handed out. Words in double angle brackets are things that an attacker might know,
filled in by `attack_class.py`, or the name of a file of `parts/`, whose text stands there.

A file of `crafted/` is a program of the tests' own that makes a submission which no notebook file could hold: its
function `hand_in(folder, notebook)` writes into the submission's folder.
"""

from __future__ import annotations

import importlib.util
import tomllib
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tests.cases import cases

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

HERE = Path(__file__).parent
FAMILIES = cases(__file__, "FAMILIES")
USUAL = "lab_1_2"


@dataclass(frozen=True)
class Attack:
    """One attack.

    Attributes:
        name: The student who hands it in.
        path: Its file.
        family: One of FAMILIES.
        tries: What it tries.
        could_earn: What is at stake.
        undefended: What happened without the defence.
        assignment: The notebook that it hands in.
        earned: Points honestly earned, by exercise.
        at_most: It may earn less than that.
        boxed_only: Not to be run without a box.
        refused: What lies there is no file, and the instructor is told.
        says: What its pages or its evidence must have, because it shows that the attack was run.

    """

    name: str
    path: Path
    family: str
    tries: str
    could_earn: str
    undefended: str = ""
    assignment: str = USUAL
    earned: Mapping[str, float] = field(default_factory=dict)
    at_most: bool = False
    boxed_only: bool = False
    refused: bool = False
    says: str = ""

    @property
    def is_program(self) -> bool:
        """Whether the file is a program that makes the submission."""
        return self.path.parent.name == "crafted"

    def cells(self) -> list[tuple[str, str, str]]:
        """Kind, name and text of each cell that the file gives."""
        found = []
        for part in ("\n" + self.path.read_text(encoding="utf-8")).split("\n# %% ")[1:]:
            head, _, source = part.partition("\n")
            kind, _, name = head.strip().partition(" ")
            found.append((kind, name, source.strip("\n")))
        return found

    def program(self) -> Any:
        """The module of a file of `crafted/`."""
        spec = importlib.util.spec_from_file_location(f"crafted_{self.name}", self.path)
        assert spec is not None
        assert spec.loader is not None
        module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
        return module


def attacks() -> Iterator[Attack]:
    """Every attack of the bank."""
    for path in sorted([*HERE.glob("bank/*/*.py"), *HERE.glob("crafted/*.py")]):
        yield Attack(name=path.stem, path=path, **_header(path))


def _header(path: Path) -> dict[str, Any]:
    lines = []
    for line in path.read_text(encoding="utf-8").splitlines():
        if not line.startswith("#") or line.startswith("# %%"):
            break
        lines.append(line[2:])
    return tomllib.loads("\n".join(lines))
