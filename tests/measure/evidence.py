"""What the judge saw of each answer of the bank, kept to be judged again.

``tests/evidence`` has a file for each exercise, a line of JSON for each answer. A test decides all of it anew, by the
present criteria and diagnoses. An answer is judged here where its evidence is missing, of another text, or was seen by
another scenario or bench (``tests/measure/stimulus.py``); what is up to date stays as it is, byte for byte.
"""

from __future__ import annotations

import contextlib
import functools
import hashlib
import json
import lzma
import subprocess
import sys
import tempfile
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import msgspec

from autograder import course, exercises
from autograder.appeals.replaying import CannotReplay, replay
from autograder.authoring.answer_bank import Answer, Turn, answers, judge_all, warm_up
from autograder.judge import evidence_files
from autograder.judge.evidence_files import Kept, evidence_of, packed, plain, restored, unpack
from autograder.verdict import State, to_json
from autograder.workspaces.builds import build_cache
from tests.cards import sweep
from tests.judge import quoting, shown_early
from tests.measure import bank, stimulus

if TYPE_CHECKING:
    import argparse
    from collections.abc import Mapping, Sequence

    from autograder.verdict import Verdict

FOLDER = Path(__file__).parents[1] / "evidence"
COMMAND = "python -m tests.measure evidence"
RECORD = (sys.executable, "-m", "autograder", "record", "--check")
"""What compares recordings with what their solutions do now."""


class BadEvidence(ValueError):
    """Evidence of an answer that cannot be judged again. The message says why, and with which command it is made."""


class Record(msgspec.Struct, frozen=True):
    """The evidence of one answer.

    Attributes:
        answer: The answer's name.
        program: The digest of what was run.
        stimulus: The digest of what else decides on what was seen.
        seen: The evidence.
    """

    answer: str
    program: str
    stimulus: str
    seen: Kept


@dataclass(frozen=True)
class Seen:
    """An answer that leaves its evidence in a folder while it is judged.

    Attributes:
        answer: The answer.
        folder: Where to.
    """

    answer: Answer
    folder: Path

    @property
    def name(self) -> str:
        """The answer's."""
        return self.answer.name

    @property
    def file(self) -> Path:
        """Where its line is left."""
        return self.folder / hashlib.sha256(self.name.encode()).hexdigest()

    def verdict(self, seed: str) -> bytes:
        """Judge it in this process; the verdict as JSON."""
        verdict, found = self.answer.checked(seed)
        if found is not None:
            # When that was must not tell two makings of the same evidence apart.
            seen = msgspec.structs.replace(unpack(packed(found)), at=0.0)
            again = replay(seen)
            if replace(again.now, seconds=verdict.seconds) != verdict:
                return to_json(replace(verdict, state=State.NOT_CHECKED, detail="; ".join(again.differences)))
            record = Record(self.name, program(self.answer), stimulus.digest(self.answer.exercise), seen)
            self.file.write_text(_line(record), encoding="utf-8")
        return to_json(verdict)


def program(answer: Answer) -> str:
    """The digest of what is run for an answer, and of its name."""
    told = hashlib.sha256("\0".join((answer.name, answer.text, *answer.command[1:])).encode())
    for file in sorted(answer.base.rglob("*")) if answer.base else ():
        if file.is_file() and file.suffix != ".pyc":
            told.update(f"\0{file.relative_to(answer.base or file)}\0".encode() + file.read_bytes())
    return told.hexdigest()


def _line(record: Record) -> str:
    """The line of a record, without the places of the machine that it was made on."""
    text = json.dumps(plain(msgspec.to_builtins(record)), ensure_ascii=False)
    for place, name in _places().items():
        text = text.replace(place, name)
        for cut in range(1, len(place) + 1):  # the end of a log may begin in the middle of a path
            text = text.replace(f'"{place[cut:]}/.venv/', f'"{name}/.venv/')
    content = json.loads(text)
    return json.dumps({"mark": _mark(content), **content}, ensure_ascii=False)


def _places() -> dict[str, str]:
    """The clone, the cache of builds and Python's own folder, by the names that stand for them in evidence."""
    python = f"{sys.base_prefix}/lib/python"
    return {str(course.root()): "/course", str(build_cache.root()): "/cache", python: "/usr/lib/python"}


def _mark(content: Mapping[str, Any]) -> str:
    return hashlib.sha256(json.dumps(content, ensure_ascii=False).encode()).hexdigest()


def _file(exercise_id: str) -> Path:
    return FOLDER / f"{exercise_id}.xz"


def lines(file: Path) -> dict[str, str]:
    """The lines of a file of evidence by the names of their answers; none where there is no such file.

    Raises:
        BadEvidence: It is cut, or no file of evidence.
    """
    try:
        text = lzma.decompress(file.read_bytes()).decode()
        return {json.loads(line)["answer"]: line for line in text.splitlines()}
    except FileNotFoundError:
        return {}
    except (lzma.LZMAError, ValueError, KeyError, TypeError) as error:
        raise BadEvidence(f"{file.name} is damaged ({error}): remove it; {COMMAND} {file.stem}/") from None


@functools.cache
def kept(exercise_id: str) -> dict[str, str]:
    """The lines of an exercise's evidence, by the names of the answers.

    Raises:
        BadEvidence: Its file is damaged.
    """
    return lines(_file(exercise_id))


def record_of(answer: Answer, line: str | None) -> Record:
    """The evidence of an answer.

    Args:
        answer: The answer.
        line: What is kept of it.

    Raises:
        BadEvidence: It is missing, damaged, another answer's, or of another text.
    """
    why = "is missing"
    if line is not None:
        content = json.loads(line)
        whole = content.pop("mark", None) == _mark(content)
        if whole and (content["answer"], content["program"]) == (answer.name, program(answer)):
            return msgspec.convert(json.loads(json.dumps(content), object_hook=restored), type=Record)
        why = (
            "was seen of another program, or before this one was changed" if whole else "was changed by hand"
        )
    raise BadEvidence(f"the evidence of {answer.name} {why}: {COMMAND} {answer.name}")


def is_of_another_bench(answer: Answer) -> bool:
    """Whether its evidence was seen by another scenario or bench, so that the answer has to be judged itself."""
    try:
        line = kept(answer.exercise).get(answer.name)
    except BadEvidence:
        return False  # a failure of its own
    return line is not None and stimulus.digest(answer.exercise) not in line.partition('"seen"')[0]


def exercises_of_another_bench() -> list[str]:
    """The exercises with an answer of which that holds."""
    return sorted({answer.exercise for answer in answers() if is_of_another_bench(answer)})


def objection(answer: Answer) -> str:
    """What the present criteria, diagnoses and cards say of an answer's evidence and should not; empty if all is well.

    Of evidence that another scenario or bench has seen, no more than that it is this answer's.
    """
    try:
        record = record_of(answer, kept(answer.exercise).get(answer.name))
        if is_of_another_bench(answer):
            return ""
        now = replay(record.seen).now
        quoted = evidence_of(record.seen, evidence_files.load_reference(answer.exercise))
        why = answer.objection(now) or sweep.objection(now) or quoting.objection(now, quoted)
        why = why or shown_early.objection(now, quoted)
    except CannotReplay as error:
        return f"{answer.name}: {error}; {COMMAND} {answer.name}"
    except BadEvidence as error:
        return str(error)
    return why and f"{answer.name}: {why}"


def make(wanted: Sequence[Answer], *, jobs: int) -> list[str]:
    """Judge answers and keep the evidence; what did not come out as expected. The process must have no threads."""
    troubles: list[str] = []
    made: dict[str, dict[str, str]] = {}

    def done(turn: Turn[Seen], verdict: Verdict) -> None:
        answer = turn.subject.answer
        if turn.subject.file.exists():
            made.setdefault(answer.exercise, {})[answer.name] = turn.subject.file.read_text(encoding="utf-8")
        if objection := answer.objection(verdict):
            troubles.append(f"{answer.name}: {objection}")

    def failed(turn: Turn[Seen], trouble: str) -> None:
        troubles.append(f"{turn.subject.name}: {trouble}")

    with tempfile.TemporaryDirectory(prefix="evidence-") as folder:
        warm_up()
        for exercise_id in {answer.exercise for answer in wanted}:
            stimulus.digest(exercise_id)  # once, before all the forks
        turns = [Turn(Seen(answer, Path(folder)), "evidence") for answer in bank.longest_first(wanted)]
        judge_all(turns, jobs=jobs, done=done, failed=failed)
    for exercise_id in exercises.all_ids():
        _write(exercise_id, made.get(exercise_id, {}))
    for file in FOLDER.glob("*.xz"):
        if file.stem not in exercises.all_ids():
            file.unlink()
    return troubles


def _write(exercise_id: str, new: Mapping[str, str]) -> None:
    """Keep new lines beside those that are there, in the order of the bank, without those of answers that are gone."""
    file = _file(exercise_id)
    found = dict(new)
    with contextlib.suppress(BadEvidence):
        found = {**lines(file), **new}
    text = "".join(f"{found[one.name]}\n" for one in answers([exercise_id]) if one.name in found)
    data = lzma.compress(text.encode())
    if text and (not file.exists() or file.read_bytes() != data):
        file.write_bytes(data)


def _is_up_to_date(answer: Answer) -> bool:
    try:
        record_of(answer, kept(answer.exercise).get(answer.name))
    except BadEvidence:
        return False
    return not is_of_another_bench(answer)


def arguments(parser: argparse.ArgumentParser) -> None:
    """Options of this program."""
    bank.of_answers(parser)
    parser.add_argument("--anew", action="store_true", help="also what is up to date")


def main(options: argparse.Namespace) -> int:
    """Make evidence; 1 where an answer did not come out as expected, or a recording is out of date.

    Evidence of the present bench says that a recording is, too, so that no test records it again.
    """
    listed = bank.chosen(options.only)
    wanted = [one for one in listed if options.anew or not _is_up_to_date(one)]
    changed = sorted({one.exercise for one in wanted if options.anew or is_of_another_bench(one)})
    if changed and subprocess.run([*RECORD, *changed], check=False).returncode:
        print(
            "Nothing is kept: a recording is not what the solution does today. ./course record, then this again."
        )
        return 1
    troubles = make(wanted, jobs=options.jobs)
    print(*troubles, f"{len(wanted)} judged, {len(troubles)} not as expected", sep="\n")
    print(f"{len(listed) - len(wanted)} had evidence that is up to date")
    return 1 if troubles else 0
