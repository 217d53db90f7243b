"""What the evidence of earlier days says of each answer of the bank, decided by the present criteria and diagnoses.

Git keeps each version of ``tests/evidence``: looks at one answer on different days, under different loads. Nothing is
run. Where two looks at the same program, by the same scenario and bench, come out differently, chance has a part in
the verdict. Where only the scenario differs, a later one may have mended that.
"""

from __future__ import annotations

import json
import lzma
import subprocess
from collections import Counter, defaultdict
from typing import TYPE_CHECKING

import msgspec

from autograder import course
from autograder.appeals.replaying import CannotReplay, replay
from autograder.judge.evidence_files import restored
from tests.measure import bank
from tests.measure.evidence import FOLDER, Record, program

if TYPE_CHECKING:
    import argparse
    from collections.abc import Iterable, Iterator, Mapping

    from autograder.authoring.answer_bank import Answer

Outcome = tuple[str, float, str]
"""State, points and key of the diagnosis."""
Looks = dict[str, list[Outcome]]
"""What the looks at an answer say now, by the digest of the scenario and bench that they were made with."""


def kept_lines() -> Iterator[str]:
    """The lines of each version of the evidence, the newest first; none where the clone has no history."""
    folder = str(FOLDER.relative_to(course.root()))
    seen: set[str] = set()
    for commit in _git("log", "--format=%h", "--", folder).decode().split():
        for entry in _git("ls-tree", "-r", commit, folder).decode().splitlines():
            blob = entry.split()[2]
            if blob not in seen and entry.endswith(".xz"):
                yield from lzma.decompress(_git("cat-file", "blob", blob)).decode().splitlines()
            seen.add(blob)


def looks_at(wanted: Mapping[str, Answer], lines: Iterable[str]) -> dict[str, Looks]:
    """What the lines say now, by the names of the answers.

    Left out are lines that another program was seen for, and those that are written in an earlier form.
    """
    programs = {name: program(answer) for name, answer in wanted.items()}
    found: dict[str, Looks] = defaultdict(lambda: defaultdict(list))
    done: set[str] = set()
    for line in lines:
        content = json.loads(line)
        name, seen = content["answer"], json.dumps(content["seen"], sort_keys=True)
        if programs.get(name) != content["program"] or seen in done:
            continue
        done.add(seen)
        content.pop("mark", None)
        try:
            record = msgspec.convert(json.loads(json.dumps(content), object_hook=restored), type=Record)
            now = replay(record.seen).now
        except (CannotReplay, msgspec.ValidationError):
            continue
        key = now.diagnosis.key if now.diagnosis else ""
        found[name][record.stimulus].append((str(now.state), now.score, key))
    return found


def by_chance(looks: Looks) -> bool:
    """Whether one scenario has seen what comes out differently."""
    return any(len(set(outcomes)) > 1 for outcomes in looks.values())


def _git(*words: str) -> bytes:
    return subprocess.run(["git", *words], cwd=course.root(), check=True, stdout=subprocess.PIPE).stdout


def arguments(parser: argparse.ArgumentParser) -> None:
    """Options of this program."""
    parser.add_argument("only", nargs="*", help="parts of the names of answers, such as lab_1_4 or /wrong/")


def main(options: argparse.Namespace) -> int:
    """Name the answers of which two looks say different things; 1 where one scenario has seen both."""
    found = looks_at({answer.name: answer for answer in bank.chosen(options.only)}, kept_lines())
    looks = differing = chance = 0
    for name, by_scenario in sorted(found.items()):
        outcomes = Counter(one for of in by_scenario.values() for one in of)
        looks += outcomes.total()
        if len(outcomes) > 1:
            differing, chance = differing + 1, chance + by_chance(by_scenario)
            said = ", ".join(f"{times} times {' '.join(map(str, one))}" for one, times in outcomes.items())
            print(f"{name}: {said}{' (by one scenario)' if by_chance(by_scenario) else ''}")
    print(f"{looks} looks at {len(found)} answers: {differing} differ, {chance} of them by one scenario")
    return 1 if chance else 0
