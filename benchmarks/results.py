"""The figures of one run, as they are kept in ``benchmarks/results.json`` and shown in ``docs/performance.md``."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import msgspec

from benchmarks.machine import Machine  # noqa: TC001  (msgspec reads the annotations)

if TYPE_CHECKING:
    from pathlib import Path

BEGIN, END = "<!-- figures: written by the benchmark -->", "<!-- end of figures -->"


@dataclass(frozen=True)
class Figure:
    """One figure.

    Attributes:
        name: What was measured.
        aim: What is wanted, in words.
        measured: What came out, in words.
        reached: Whether the aim is reached.
        load: The machine meanwhile: its load average, and the share that other processes took if known.
    """

    name: str
    aim: str
    measured: str
    reached: bool
    load: str


@dataclass(frozen=True)
class Results:
    """All figures of one run.

    Attributes:
        machine: What they were measured on.
        when: The day.
        form: ``"full"`` or ``"short"``.
        minutes: How long the run took.
        figures: In the order in which they are shown.
        notes: Sentences about what was measured.
        differences: Points that are not the same in stock nbgrader and here, and problems of the run.
    """

    machine: Machine
    when: str
    form: str
    minutes: float
    figures: tuple[Figure, ...] = ()
    notes: tuple[str, ...] = ()
    differences: tuple[str, ...] = ()


def markdown(results: Results) -> str:
    """The figures as a piece of Markdown."""
    machine = results.machine
    lines = [
        f"Measured on {results.when} in {results.minutes:.0f} minutes, {results.form} form, on {machine.cores} cores "
        f"with {machine.memory_gib:g} GiB, {machine.system}, CPython {machine.python}.",
        "",
        "| what | aim | measured | reached | load while measuring |",
        "| --- | --- | --- | --- | --- |",
    ]
    for figure in results.figures:
        reached = "yes" if figure.reached else "**no**"
        lines.append(f"| {figure.name} | {figure.aim} | {figure.measured} | {reached} | {figure.load} |")
    lines += ["", *(f"- {note}" for note in results.notes)]
    if results.differences:
        lines += ["", "Differences:", "", *(f"- {difference}" for difference in results.differences)]
    return "\n".join(lines).rstrip() + "\n"


def write(results: Results, path: Path) -> None:
    """Keep the figures as JSON."""
    path.write_bytes(msgspec.json.format(msgspec.json.encode(results), indent=2) + b"\n")


def read(path: Path) -> Results:
    """Read kept figures.

    Raises:
        OSError: They cannot be read.
        msgspec.DecodeError: They are none.
    """
    return msgspec.json.decode(path.read_bytes(), type=Results)


def put_into(page: Path, results: Results) -> None:
    """Replace the figures that a page quotes.

    Raises:
        ValueError: The page has no place for them.
    """
    replace_between(page, BEGIN, END, markdown(results))


def replace_between(page: Path, begin: str, end: str, text: str) -> None:
    """Replace what stands between two lines of a page.

    Raises:
        ValueError: The page does not have both.
    """
    before, found_begin, rest = page.read_text(encoding="utf-8").partition(begin)
    _, found_end, after = rest.partition(end)
    if not found_begin or not found_end:
        raise ValueError(f"{page} has no place for the figures: {begin} … {end}")
    page.write_text(f"{before}{begin}\n\n{text}\n{end}{after}", encoding="utf-8")
