"""What the judge says otherwise of the bank in another commit.

Each commit gets a work tree of its own, whose judge judges that tree's answers with the same seeds, both at the same
time. Compared are the state, the points of each criterion and the diagnosis; with ``--texts`` also what the student is
told, numbers aside. The environment (ROS, Python packages) is that of this clone for both.

Where two verdicts differ, chance may have done it. Such an answer is judged again in both trees, and differs only where
the second commit says of it what the first one never said. The exit code is 1 where an answer differs or is gone, 2
where the commits or the answers cannot be found.
"""

from __future__ import annotations

import contextlib
import json
import os
import re
import subprocess
import sys
import tempfile
from collections import defaultdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import argparse
    from collections.abc import Iterable, Iterator, Mapping, Sequence

    from autograder.verdict import Verdict

ROOT = Path(__file__).resolve().parents[2]
JOBS = 4
"""Answers that are judged at once in each of the two trees."""
SEEDS = 2
"""How often each answer is judged, each time with other inputs."""
AGAIN = 4
"""How often an answer is judged once more of which two verdicts differ."""

Outcomes = dict[str, dict[str, str]]
"""For the name of an answer, what was said of it with each seed."""


class CannotCompare(Exception):
    """Nothing can be compared. The message says why, for whoever called the program."""


# --- in each tree: this file runs there as a program, whatever that tree's tests are -----------------------------


def judge_here(out: Path, parts: Sequence[str], seeds: Sequence[str], jobs: int, *, texts: bool) -> None:
    """Judge the answers of the tree that ``PYTHONPATH`` names, and write a line for each verdict.

    Args:
        out: Where to: lines of JSON with the answer's name, the seed, and what was said of it.
        parts: Parts of the names of answers; all where empty.
        seeds: With which each of them is judged.
        jobs: How many at once.
        texts: Whether what the student is told belongs to it.
    """
    from autograder import exercises
    from autograder.authoring.answer_bank import Answer, Turn, answers, judge_all, warm_up

    wanted = [answer for answer in answers() if not parts or any(part in answer.name for part in parts)]
    # Slow answers start first, so that none of them runs alone at the end.
    wanted.sort(key=lambda answer: -exercises.get(answer.exercise).limit)
    with out.open("w", encoding="utf-8") as lines:

        def take(turn: Turn[Answer], said: str) -> None:
            print(json.dumps([turn.subject.name, turn.seed, said]), file=lines, flush=True)

        warm_up()
        judge_all(
            [Turn(answer, seed) for answer in wanted for seed in seeds],
            jobs=jobs,
            done=lambda turn, verdict: take(turn, outcome(verdict, texts=texts)),
            failed=lambda turn, _: take(turn, "no verdict"),
        )


def outcome(verdict: Verdict, *, texts: bool) -> str:
    """What a verdict says, in one line: state, points, the criteria that do not hold, diagnosis."""
    missed = " ".join(c.name for c in verdict.criteria if not c.passed)
    found = verdict.diagnosis
    said = f"{verdict.state} {verdict.score:g}/{verdict.max_score:g} [{missed}] {found.key if found else ''}"
    if texts and found:
        said += f": {found.text} | {found.next_step}"
        said = said.partition(":")[0] + re.sub(r"\d+", "#", said[said.index(":") :])
    return said.rstrip()


# --- over both trees -----------------------------------------------------------------------------------------


@contextlib.contextmanager
def work_tree(commit: str, folder: Path) -> Iterator[Path]:
    """A work tree of a commit, as long as the block runs.

    Raises:
        CannotCompare: There is no such commit.
    """
    added = _git("worktree", "add", "--detach", str(folder), commit)
    if added.returncode:
        raise CannotCompare(f"no work tree of {commit} can be made: {added.stderr.strip().splitlines()[-1]}")
    try:
        yield folder
    finally:
        _git("worktree", "remove", "--force", str(folder))


def _git(*words: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(["git", *words], cwd=ROOT, capture_output=True, text=True, check=False)


def judged(trees: Sequence[Path], parts: Sequence[str], seeds: Sequence[str], more: Any) -> list[Outcomes]:
    """What is said of the answers in each tree.

    Args:
        trees: The work trees; each judges by itself, all at once.
        parts: Parts of the names of answers; all where empty.
        seeds: With which each answer is judged.
        more: The options ``jobs`` and ``texts``.

    Raises:
        CannotCompare: A tree's judge ended with an error, which stands above.
    """
    orders = json.dumps({"parts": parts, "seeds": seeds, "jobs": more.jobs, "texts": more.texts})
    running = [
        subprocess.Popen(
            [sys.executable, "-P", str(Path(__file__).resolve()), f"{tree}.lines", orders],
            cwd=tree,
            env=os.environ | {"PYTHONPATH": str(tree)},
            stdout=subprocess.DEVNULL,
        )
        for tree in trees
    ]
    codes = [process.wait() for process in running]
    if any(codes):
        raise CannotCompare("the judge of a tree ended with an error, which stands above")
    return [_read(Path(f"{tree}.lines")) for tree in trees]


def _read(file: Path) -> Outcomes:
    found: Outcomes = defaultdict(dict)
    for line in file.read_text(encoding="utf-8").splitlines():
        name, seed, said = json.loads(line)
        found[name][seed] = said
    return dict(found)


def unlike(first: Mapping[str, Mapping[str, str]], second: Mapping[str, Mapping[str, str]]) -> list[str]:
    """The answers of both commits of which something else is said with one and the same seed."""
    return [name for name in first if name in second and first[name] != second[name]]


def differing(first: Outcomes, second: Outcomes, names: Iterable[str]) -> list[str]:
    """Those of the answers of which the second commit says what the first one never said."""
    return [name for name in names if set(second[name].values()) - set(first[name].values())]


def compare(more: Any) -> bool:
    """Judge the answers of two commits and print what is said otherwise; whether nothing is.

    Args:
        more: The options.

    Raises:
        CannotCompare: There is no such commit, or no such answer, or a tree's judge ended with an error.
    """
    commits, parts = (more.first, more.second), more.only
    seeds = [f"compare-{number}" for number in range(more.seeds + AGAIN)]
    with tempfile.TemporaryDirectory(prefix="compare-") as folder, contextlib.ExitStack() as stack:
        trees = [
            stack.enter_context(work_tree(commit, Path(folder) / side))
            for commit, side in zip(commits, "ab", strict=True)
        ]
        first, second = judged(trees, parts, seeds[: more.seeds], more)
        lost = [part for part in parts if not any(part in name for name in (*first, *second))]
        if lost:
            raise CannotCompare(f"neither commit has an answer with {' or '.join(lost)} in its name")
        doubtful = unlike(first, second)
        if doubtful:
            print(f"{len(doubtful)} judged again: {', '.join(doubtful)}", flush=True)
            for known, new in zip(
                (first, second), judged(trees, doubtful, seeds[more.seeds :], more), strict=True
            ):
                for name in doubtful:
                    known[name] |= new[name]
    return told(first, second, doubtful)


def told(first: Outcomes, second: Outcomes, doubtful: Sequence[str]) -> bool:
    """Print what is said otherwise; whether nothing is.

    Args:
        first: What was said in the first commit.
        second: And in the second one.
        doubtful: The answers of which two verdicts differ.
    """
    differ, gone = differing(first, second, doubtful), sorted(first.keys() - second.keys())
    for name in doubtful:
        print(
            f"\n{name}: {'differs' if name in differ else 'not always the same, in the first commit either'}"
        )
        for sign, found in (("-", first[name]), ("+", second[name])):
            values = list(found.values())
            for said in dict.fromkeys(values):
                print(f"  {sign} {values.count(said)} times {said}")
    for name in gone:
        print(f"{name}: gone")
    for name in sorted(second.keys() - first.keys()):
        print(f"{name}: new, not compared")
    both = len(first.keys() & second.keys())
    print(f"\n{both} answers compared, {len(differ) or 'none'} differ, {len(gone) or 'none'} gone")
    return not differ and not gone


def arguments(parser: argparse.ArgumentParser) -> None:
    """Options of this program."""
    parser.add_argument("first", metavar="COMMIT_A", help="such as HEAD~1")
    parser.add_argument("second", metavar="COMMIT_B")
    parser.add_argument("only", nargs="*", help="parts of the names of answers; all by default")
    parser.add_argument("--seeds", type=int, default=SEEDS, help=f"how often each is judged ({SEEDS})")
    parser.add_argument("--jobs", type=int, default=JOBS, help=f"judged at once in each tree ({JOBS})")
    parser.add_argument("--texts", action="store_true", help="compare what students are told, too")


def main(options: argparse.Namespace) -> int:
    """Compare; 1 where something differs or is gone, 2 where the commits or the answers cannot be found."""
    try:
        return 0 if compare(options) else 1
    except CannotCompare as error:
        print(error, file=sys.stderr)
        return 2


if __name__ == "__main__":
    judge_here(Path(sys.argv[1]), **json.loads(sys.argv[2]))
