"""How often the judge is right and how often it says the same, measured and published.

Judges the bank, a sample of mutants, the bank in a soak, and a class again and again; keeps the figures in
``docs/accuracy.json`` and puts them into ``docs/accuracy.md``. Each part runs as the command that stands in its row.
"""

from __future__ import annotations

import datetime
import secrets
import subprocess
import sys
import time
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import msgspec

from autograder import course
from autograder.authoring.answer_bank import answers
from autograder.verdict import from_json
from benchmarks.machine import Machine, machine
from benchmarks.results import replace_between
from tests.measure.ends import Repeated, in_words
from tests.mutation.report import Report

if TYPE_CHECKING:
    import argparse
    from collections.abc import Iterable

    from autograder.authoring.answer_bank import Answer
    from autograder.verdict import Verdict

PAGE = course.root() / "docs" / "accuracy.md"
RESULTS = PAGE.with_suffix(".json")
BEGIN, END = "<!-- rates: written by tests.measure rates -->", "<!-- end of rates -->"


@dataclass(frozen=True)
class Form:
    """How much is measured.

    Attributes:
        name: ``"full"`` or ``"short"``.
        bank: Parts of the names of answers that are judged once and in the soak; all where empty.
        mutants: How many are judged.
        judgements: Of the soak.
        times: How often the class is graded.
    """

    name: str
    bank: tuple[str, ...]
    mutants: int
    judgements: int
    times: int


FULL = Form("full", (), 300, 1_000, 30)
SHORT = Form("short", ("lab_1_2.talker/right", "lab_1_3.client"), 26, 150, 2)


@dataclass(frozen=True)
class Bank:
    """What came of judging every answer of the bank once.

    Attributes:
        right: Right answers.
        accepted: Those of them with full marks.
        wrong: Wrong answers.
        rejected: Those of them without full marks.
        diagnosed: Those of them with a diagnosis that is listed for them.
        first: Those of them with the first one that is listed.
        objections: What was not as expected.
    """

    right: int
    accepted: int
    wrong: int
    rejected: int
    diagnosed: int
    first: int
    objections: tuple[str, ...] = ()


@dataclass(frozen=True)
class Measured:
    """How a part was measured.

    Attributes:
        form: ``"full"`` or ``"short"``.
        when: The day.
        minutes: Wall time.
        command: What measures this part alone.
    """

    form: str
    when: str
    minutes: float
    command: str


@dataclass(frozen=True)
class Rates:
    """All parts, each with how it was measured; None where a part was never measured."""

    machine: Machine
    bank: tuple[Measured, Bank] | None = None
    mutants: tuple[Measured, Report] | None = None
    soak: tuple[Measured, Repeated] | None = None
    steady_class: tuple[Measured, Repeated] | None = None


PARTS = ("bank", "mutants", "soak", "steady_class")


class NotMeasured(RuntimeError):
    """A part could not be measured. The message has the last lines of what it said."""


def measured(part: str, form: Form) -> Any:
    """Measure a part; what stands in :class:`Rates` under its name.

    Args:
        part: One of :data:`PARTS`.
        form: How much.

    Raises:
        NotMeasured: It could not be.
    """
    seed = str(secrets.randbelow(100_000))
    options: dict[str, list[str]] = {
        "bank": ["--lines", *form.bank],
        "mutants": ["--sample", str(form.mutants), "--seed", seed, "--json"],
        "soak": ["--judgements", str(form.judgements), "--seed", seed, "--json", *form.bank],
        "steady_class": ["--times", str(form.times), "--json"],
    }
    command = ["-m", "tests.measure", part, *options[part]]
    print(f"{part}: python {' '.join(command)}", file=sys.stderr, flush=True)
    began = time.monotonic()
    done = subprocess.run(
        [sys.executable, *command], cwd=course.root(), stdout=subprocess.PIPE, text=True, check=False
    )
    # 1 is for what is not as it should be, which is a figure; the bank's lines have it in them.
    if done.returncode not in ((0,) if part == "bank" else (0, 1)) or not done.stdout:
        raise NotMeasured(f"{part}: exit code {done.returncode}\n{done.stdout[-500:]}")
    minutes = (time.monotonic() - began) / 60
    told = " ".join(word for word in command if word not in ("--json", "--lines"))
    today = datetime.datetime.now(tz=datetime.UTC).date().isoformat()
    if part == "bank":
        found: object = bank_rates(dict(line.split(" ", 1) for line in done.stdout.splitlines()))
    else:
        found = msgspec.json.decode(done.stdout, type=Report if part == "mutants" else Repeated)
    return Measured(form.name, today, minutes, f"python {told}"), found


def bank_rates(lines: dict[str, str], listed: Iterable[Answer] | None = None) -> Bank:
    """Count the verdicts on answers of the bank.

    Args:
        lines: Verdicts as JSON, by the answers' names.
        listed: The answers; those of the bank by default.
    """
    judged = [
        (answer, from_json(lines[answer.name])) for answer in listed or answers() if answer.name in lines
    ]
    right = [verdict for answer, verdict in judged if not answer.diagnoses]
    wrong = [(answer, verdict) for answer, verdict in judged if answer.diagnoses]
    objections = [f"{a.name}: {why}" for a, verdict in judged if (why := a.objection(verdict))]
    return Bank(
        right=len(right),
        accepted=sum(verdict.passed for verdict in right),
        wrong=len(wrong),
        rejected=sum(verdict.state == "failed" for _, verdict in wrong),
        diagnosed=sum(_key(verdict) in answer.diagnoses for answer, verdict in wrong),
        first=sum(_key(verdict) == answer.diagnoses[0] for answer, verdict in wrong),
        objections=tuple(objections),
    )


def _key(verdict: Verdict) -> str:
    return verdict.diagnosis.key if verdict.diagnosis else ""


def markdown(rates: Rates) -> str:
    """The figures as a piece of Markdown: the rates, how each part was measured, what was not as expected."""
    on = rates.machine
    rows = ["| what | part | rate |", "| --- | --- | --- |"]
    ways: list[str] = []
    details: list[str] = []
    if rates.bank:
        how, bank = rates.bank
        rows += [
            _row("right answers that are accepted", "bank", _of(bank.accepted, bank.right)),
            _row("wrong answers that are rejected", "bank", _of(bank.rejected, bank.wrong)),
            _row("wrong answers with a diagnosis that is right", "bank", _of(bank.diagnosed, bank.wrong)),
            _row("wrong answers with the most useful diagnosis", "bank", _of(bank.first, bank.wrong)),
        ]
        ways.append(_way("bank", how))
        details += [f"- bank: {objection}" for objection in bank.objections]
    if rates.mutants:
        how, found = rates.mutants
        total = found.total
        left = total.killed + total.survived
        judged = left + total.equivalent
        rows += [
            _row("mutants of right answers that are rejected", "mutants", _of(total.killed, judged)),
            _row("the same, without those that do what the task asks", "mutants", _of(total.killed, left)),
            _row("rejected mutants with a specific diagnosis", "mutants", _of(total.told, total.killed)),
        ]
        ways.append(_way("mutants", how, f"{judged + total.not_checked} of {found.made}"))
        if found.survivors:
            details.append(f"- mutants that survived: {', '.join(f'`{one.id}`' for one in found.survivors)}")
    for name, part, what in (
        ("soak", rates.soak, "answers with the same points and diagnosis each time, under load"),
        (
            "steady_class",
            rates.steady_class,
            "verdicts that stay the same when a class is graded again and again",
        ),
    ):
        if part:
            how, ends = part
            rows.append(_row(what, name, _of(ends.repeated - len(ends.changed), ends.repeated)))
            ways.append(_way(name, how, f"{ends.judgements} verdicts, {ends.how}"))
            details += [f"- changed: {answer}: {in_words(counts)}" for answer, counts in ends.changed.items()]
            details += [f"- not as expected: {answer}: {why}" for answer, why in ends.unexpected.items()]
    on_what = f"Measured on {on.cores} cores with {on.memory_gib:g} GiB, {on.system}, CPython {on.python}:"
    blocks = [rows, [on_what], ways, *([["What was not as expected:"], details] if details else [])]
    return "\n\n".join("\n".join(block) for block in blocks if block) + "\n"


def _row(what: str, part: str, rate: str) -> str:
    return f"| {what} | `{part}` | {rate} |"


def _way(part: str, how: Measured, more: str = "") -> str:
    sized = f"{more}; " if more else ""
    return f"- `{part}`: `{how.command}`: {sized}{how.form} form, {how.when}, {how.minutes:.0f} minutes"


def _of(some: int, all_: int) -> str:
    return f"{some} of {all_} ({some / all_:.1%})" if all_ else "none was judged"


def write(rates: Rates, path: Path) -> None:
    """Keep the figures as JSON."""
    path.write_bytes(msgspec.json.format(msgspec.json.encode(rates), indent=2) + b"\n")


def read(path: Path) -> Rates:
    """Read kept figures.

    Raises:
        OSError: They cannot be read.
        msgspec.DecodeError: They are none.
    """
    return msgspec.json.decode(path.read_bytes(), type=Rates)


def arguments(parser: argparse.ArgumentParser) -> None:
    """Options of this program."""
    parser.add_argument("parts", nargs="*", metavar="PART", help=f"only these: {', '.join(PARTS)}")
    parser.add_argument("--short", action="store_true", help="minutes instead of three quarters of an hour")
    parser.add_argument("--output", type=Path, help="keep the figures here, and leave the page alone")


def main(options: argparse.Namespace) -> int:
    """Measure, keep, put into the page; 1 where a part could not be measured, 2 where there is no such part."""
    if unknown := set(options.parts) - set(PARTS):
        print(f"no such part: {', '.join(sorted(unknown))}", file=sys.stderr)
        return 2
    output: Path = options.output or RESULTS
    rates = read(output) if output.exists() else Rates(machine())
    rates = replace(rates, machine=machine())
    failed = []
    for part in options.parts or PARTS:
        try:
            rates = replace(rates, **{part: measured(part, SHORT if options.short else FULL)})
        except NotMeasured as error:
            failed.append(part)
            print(error, file=sys.stderr)
            continue
        write(rates, output)
        if output == RESULTS:
            replace_between(PAGE, BEGIN, END, markdown(rates))
    print(markdown(rates))
    return 1 if failed else 0
