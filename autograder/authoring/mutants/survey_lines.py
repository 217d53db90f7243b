"""Says in lines for an author what a survey of mutants has found."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from autograder.authoring.mutants.engine import Mutant
    from autograder.authoring.mutants.solutions import Solution
    from autograder.authoring.mutants.survey import Survey, Tried

SHOWN = 60
"""The greatest length of a piece of code in a line."""
GROUPS, OF_A_GROUP = 5, 3
"""The greatest numbers of groups, and of mutants of each, that are listed of those that no drawing parts."""


def lines(found: Survey) -> Iterator[str]:
    """Yield the lines: the counts, then the mutants that pass, those that chance decides, and those that are alike."""
    counts = {
        "made": found.tried,
        "set aside": found.aside,
        "rejected": found.rejected,
        "by chance": found.by_chance,
        "passing": found.passing,
    }
    numbers = ", ".join(f"{len(some)} {what}" for what, some in counts.items())
    yield f"{found.solution.exercise}: mutants of the solution: {numbers} ({found.seconds:.0f} s)"
    yield from _listed(found.solution, "Mutants with full marks in every drawing:", found.passing)
    yield from _listed(found.solution, "Mutants with full marks in some drawings:", found.by_chance)
    for group in found.alike[:GROUPS]:
        yield "  Mutants that do the same in each recorded drawing:"
        yield from (f"    {in_words(found.solution, one.mutant)}" for one in group[:OF_A_GROUP])
        if len(group) > OF_A_GROUP:
            yield f"    and {len(group) - OF_A_GROUP} more"
    if len(found.alike) > GROUPS:
        yield f"  {len(found.alike) - GROUPS} more such groups"
    for one in found.tried:
        if one.mutant.start < 0 and one.points and not one.passes:
            yield f"  {in_words(found.solution, one.mutant)} earns {one.points:.1f} points"
    for key in found.stale:
        yield f"  settings.toml accepts {key}, which is not made or does not pass: take the row out"
    if found.passing:
        yield (
            "  Not ready: draw inputs that tell what passes in every drawing, or accept it, with a reason, in the row "
            "[accepts] of settings.toml beside the exercise's answers"
        )


def _listed(of: Solution, title: str, listed: Sequence[Tried]) -> Iterator[str]:
    if listed:
        yield f"  {title}"
    for one in listed:
        share = "" if one.passes else f"{one.passed} of {len(one.runs)}  "
        yield f"    {share}{in_words(of, one.mutant)}  [{one.mutant.key}]"


def in_words(of: Solution, mutant: Mutant) -> str:
    """Return in one line the changed line of a solution, the changed piece, and its replacement."""
    if mutant.start < 0:
        return f"an answer that does not look: it {mutant.kind}"
    name = mutant.operator.replace("_", " ")
    kind = f", {mutant.kind}" if mutant.kind else ""
    places = f", in {mutant.all_of} places of the method" if mutant.all_of > 1 else ""
    # Code that keeps values between two calls is long, and says less than the name of the operator.
    is_short = len(mutant.after) <= max(SHOWN, len(mutant.before))
    is_readable = mutant.before and is_short and "__" not in mutant.after
    change = f": {_short(mutant.before)} → {_short(mutant.after) or 'nothing'}" if is_readable else ""
    return f"“{_around(of.text, mutant.start, mutant.before)}”: {name}{kind}{places}{change}"


def _around(text: str, start: int, piece: str) -> str:
    """Return the line of a piece of code, or its part around the piece, which is marked if the line has it twice."""
    begin = text.rfind("\n", 0, start) + 1
    line, place = text[begin:].partition("\n")[0], start - begin
    if piece and line.count(piece) > 1:
        line = f"{line[:place]}»{piece}«{line[place + len(piece) :]}"
    indentation = len(line) - len(line.lstrip())
    first = max(indentation, min(place - SHOWN // 2, len(line) - SHOWN))
    cut = "…" * (first > indentation), "…" * (first + SHOWN < len(line))
    return f"{cut[0]}{line[first : first + SHOWN]}{cut[1]}"


def _short(text: str) -> str:
    line = " ".join(text.split())
    return line if len(line) <= SHOWN else f"{line[:SHOWN]}…"
