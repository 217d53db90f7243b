"""What came of each mutant, kept line by line in a file, so that a run that was ended goes on where it was."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from typing import TYPE_CHECKING

import msgspec

from autograder.verdict import State, Verdict

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path

    from tests.mutation.mutants import Mutant

CRASHES = frozenset(
    {"crashed", "crashed_in_callback", "exception_in_callback", "syntax_error", "unknown", ""}
)
"""Diagnoses that say no more than that something went wrong."""


class Fate(StrEnum):
    """What came of a mutant."""

    KILLED = "killed"
    SURVIVED = "survived"
    EQUIVALENT = "equivalent"
    """It survived, and is entered as one that does what the task asks for."""
    NOT_CHECKED = "not_checked"


@dataclass(frozen=True)
class Result:
    """One judging of one mutant.

    Attributes:
        id: The mutant's.
        digest: Changes with its text.
        seed: What random inputs were drawn from.
        state: How the check ended.
        score: Points earned, as a share of all: from 0 to 1.
        diagnosis: The key of the diagnosis; empty where there is none.
        seconds: Wall time of the check.
    """

    id: str
    digest: str
    seed: str
    state: State
    score: float
    diagnosis: str
    seconds: float

    @property
    def fate(self) -> Fate:
        """Without regard to what is entered as equivalent."""
        if self.state is State.NOT_CHECKED:
            return Fate.NOT_CHECKED
        return Fate.SURVIVED if self.state is State.PASSED else Fate.KILLED

    @property
    def told(self) -> bool:
        """Whether the diagnosis is a specific one."""
        return self.diagnosis not in CRASHES


def result(mutant: Mutant, seed: str, verdict: Verdict) -> Result:
    """The result that follows from a verdict."""
    key = verdict.diagnosis.key if verdict.diagnosis else ""
    share = verdict.score / verdict.max_score if verdict.max_score else 0.0
    return Result(mutant.id, mutant.digest, seed, verdict.state, share, key, verdict.seconds)


def no_result(mutant: Mutant, seed: str) -> Result:
    """The result where there is no verdict."""
    return Result(mutant.id, mutant.digest, seed, State.NOT_CHECKED, 0.0, "", 0.0)


def keep(result: Result, file: Path) -> None:
    """Add a result to a file."""
    with file.open("ab") as stream:
        stream.write(msgspec.json.encode(result) + b"\n")


def kept(file: Path, mutants: Iterable[Mutant]) -> list[Result]:
    """The results of a file that still hold: those of mutants with the same text.

    Raises:
        msgspec.DecodeError: The file is none of ours.
    """
    if not file.exists():
        return []
    digests = {mutant.id: mutant.digest for mutant in mutants}
    found = [msgspec.json.decode(line, type=Result) for line in file.read_bytes().splitlines()]
    return [result for result in found if digests.get(result.id) == result.digest]
