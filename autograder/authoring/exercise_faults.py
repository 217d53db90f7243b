"""Lists for an author the faults of an exercise that the project's tests would report.

They include each house rule that the lab's master breaks, such as the limit on the words before the first task.
"""

from __future__ import annotations

import contextlib
import itertools
import re  # noqa: TID251  (not what a student handed in)
from collections import Counter
from dataclasses import replace
from typing import TYPE_CHECKING

from autograder import course, exercises
from autograder.authoring.author_texts import author_text
from autograder.judge import evidence_files
from autograder.kit.evidence import Event, Evidence
from autograder.masters.code_cells import find_region
from autograder.masters.master_cells import COPY_LINE, CellRole, parse_master
from autograder.masters.source_notebooks import named_cells

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence
    from pathlib import Path

    from autograder.authoring.answer_bank import Answer
    from autograder.kit.evidence import Reference
    from autograder.kit.model import Exercise
    from autograder.masters.source_notebooks import NamedCell


_OUTPUTS = ("publisher", "service", "action_server")
"""The roles of endpoints through which a node tells something. The others only let it know."""
_MISTAKES_PAGE = "docs/mistakes.md"
"""The page that explains each diagnosis to students. The heading of a paragraph has the keys that it explains."""


def still_to_do(exercise: Exercise, listed: Sequence[Answer]) -> Iterator[str]:
    """Yield a line for each thing that an exercise still lacks before it can be committed.

    Args:
        exercise: The exercise.
        listed: All answers to the exercise in the bank.

    Raises:
        autograder.masters.master_files.MasterError: The lab's master cannot be used.
    """
    yield from _of_endpoints(exercise)
    yield from _of_answers(listed, exercise.enough)
    yield from _of_mistakes(exercise, listed)
    yield from to_do_in_text(exercise)
    master = exercises.path(exercise.id).with_name(course.LAB)
    yield from (f"{course.LAB}: {rule}" for rule in broken_rules(master))


def _of_answers(listed: Sequence[Answer], enough: Mapping[str, int]) -> Iterator[str]:
    counts = Counter(answer.file.parent.name for answer in listed)
    few = [f"{counts[kind]} {kind}" for kind, least in enough.items() if counts[kind] < least]
    if few:
        yield author_text("few_answers", few=" and ".join(few), **enough)
    for answer in listed:
        if answer.diagnoses and not answer.file.name.startswith(answer.diagnoses[0]):
            yield author_text("other_file_name", answer=answer.short_name, diagnosis=answer.diagnoses[0])


def _of_endpoints(exercise: Exercise) -> Iterator[str]:
    if exercises.reference_path(exercise.id).exists():
        for name in unasked_outputs(exercise, evidence_files.load_reference(exercise.id)):
            yield author_text("unasked_output", name=name)


def unasked_outputs(exercise: Exercise, recorded: Reference) -> list[str]:
    """Return the names of the recorded solution's outputs without which all criteria would still be met."""
    names = sorted({name for role in _OUTPUTS for name in recorded.interface.get(role, ())})
    # A recording may lack what a criterion needs, such as the words of a program. Then nothing can be concluded.
    if not _meets_all(exercise, _without(recorded, "")):
        return []
    return [name for name in names if _meets_all(exercise, _without(recorded, name))]


def _meets_all(exercise: Exercise, evidence: Evidence) -> bool:
    # A criterion that cannot decide at all without an endpoint depends on it.
    with contextlib.suppress(Exception):
        return all(criterion.judge(evidence).passed for criterion in exercise.criteria)
    return False


def _without(recorded: Reference, gone: str) -> Evidence:
    """Return the recorded solution as evidence, as it would be without its endpoints of a name."""
    ends = {
        role: {name: of for name, of in ends.items() if name != gone}
        for role, ends in recorded.interface.items()
    }
    there = Event(0.0, "interface", "graph", {"nodes": ["/solution"], **ends})
    of_others = {name for ends in ends.values() for name in ends} if gone else None
    parts = []
    for part in recorded.parts:
        # A note about no endpoint, such as the place at which a robot stood, may be a result of the missing one.
        kept = [
            event
            for event in part.events
            if event.name != gone and (of_others is None or event.kind != "noted" or event.name in of_others)
        ]
        parts.append(replace(part, events=[there, *kept]))
    return Evidence(parts, recorded)


def _of_mistakes(exercise: Exercise, listed: Sequence[Answer]) -> Iterator[str]:
    page = course.root() / _MISTAKES_PAGE
    if page.is_file():
        headings = " ".join(re.findall(r"^### .+$", page.read_text(encoding="utf-8"), re.MULTILINE))
        used = {mistake.key for mistake in exercise.mistakes}
        used |= {key for answer in listed for key in answer.diagnoses}
        # A recorded wrong answer says on the card itself what it is, and what a mutant does has keys of its own.
        used -= {"variant", "mutant"} | {key for one in listed if one.advice for key in one.diagnoses}
        for key in sorted(used - set(re.findall(r"`(\w+)`", headings))):
            yield author_text("no_paragraph", page=_MISTAKES_PAGE, key=key)


def to_do_in_text(exercise: Exercise) -> Iterator[str]:
    """Yield a line for each fault in ``Exercise.text``, which maps sentences of the lab to criteria."""
    master = exercises.path(exercise.id).parent / course.LAB
    if not exercise.text:
        yield author_text("no_text")
        return
    lab_text = "\n".join(one.cell.source for one in named_cells(master))
    yield from (f"text: {fault}" for fault in faults_of_text(exercise, lab_text))


def faults_of_text(exercise: Exercise, lab_text: str) -> Iterator[str]:
    """Yield the faults of ``Exercise.text``: sentences that the lab does not contain, missing or unknown criteria.

    Args:
        lab_text: All texts of the lab, in one string.
    """
    words_of_lab = " ".join(lab_text.split())
    sentences = (" ".join(words.split()) for words in exercise.text)
    yield from (author_text("not_in_lab", words=words) for words in sentences if words not in words_of_lab)
    for words, names in exercise.text.items():
        if _PERIOD.search(words) and "rate" not in names:
            yield author_text("unjudged_period", words=words)
    judged = {name for names in exercise.text.values() for name in names.split()}
    known = {criterion.name for criterion in exercise.criteria}
    yield from (author_text("unmapped_criterion", name=name) for name in sorted(known - judged))
    of_criteria = {name for name in exercise.counts if name}
    yield from (author_text("no_criterion", name=name) for name in sorted((judged | of_criteria) - known))
    for name, words in exercise.counts.items():
        if len(_SENTENCE.findall(words)) > _MAX_SENTENCES:
            yield author_text("long_counts", most=_MAX_SENTENCES, name=name or "the exercise")


_PERIOD = re.compile(r"(?i)\bevery [\d.]+ s\b")
_MAX_SENTENCES = 2
"""The maximum number of sentences below a criterion, because a card must not read like a contract."""
_SENTENCE = re.compile(r"[.!?](?= |$)")


_MAX_HEAD_WORDS, _MAX_WORDS_BEFORE_A_TASK, _MAX_SOLUTION_LINES = 150, 400, 12
"""Three limits of a master: the words before the first code cell, the words before the first task, and the lines that
a student writes in one cell.
"""
_MINUTES = re.compile(r"^\*\d+ minutes · for ", re.MULTILINE)
_PICTURE = re.compile(r"!\[[^\]]*\]\([^)]*\)")
"""Matches a figure. The figure's alternative text does not count as words of the master, because it replaces the
figure for readers who cannot see it.
"""
_PREDICTION = "**Before you run it:**"
"""The first words of a question that students answer before they run a demonstration."""
_PARAGRAPH = re.compile(r"\n\s*\n|\n(?=\d+\. |- )")
_CODE = re.compile(r"`[^`]*`|\]\([^)]*\)")
"""Matches code and the address of a link. Parentheses there do not count as parentheses of a text."""
_PARENTHESIS = re.compile(r"\([^)]*\)")
_FOLD = re.compile(r"<details>.*?</details>", re.DOTALL)
"""Matches folded text. Its words do not count, because students open it only if they want to."""
_SELF_CHECK = re.compile(
    r"\*\*Check yourself:\*\*.*?\n\n(?P<choices>(?:<details>.*?</details>\s*)*)", re.DOTALL
)
_REPLY = re.compile(r"</summary>\s*(\S)")


def broken_rules(master: Path) -> list[str]:
    """Return a line for each house rule that a master breaks. A line contains the rule's name and what to write.

    Args:
        master: The path of a file ``lab.md``.

    Raises:
        autograder.masters.master_files.MasterError: The file is not a valid master.
    """
    copying = {cell.line for cell in parse_master(master) if COPY_LINE.search(cell.source)}
    # Leave out the cells that are added to each master, such as links to the neighboring labs: they have no line.
    cells = [one for one in named_cells(master) if one.cell.line]
    return [
        *_beginning(cells),
        *_solutions(one for one in cells if one.cell.line not in copying),
        *_introductions(cells),
        *_predictions(cells),
        *_tasks(cells),
        *_self_checks(filter(_is_text, cells)),
        *_end(cells),
    ]


def _beginning(cells: list[NamedCell]) -> Iterator[str]:
    head = list(itertools.takewhile(_is_text, cells))
    if _words(head) > _MAX_HEAD_WORDS:
        yield author_text("long_head", words=_words(head), most=_MAX_HEAD_WORDS)
    if not head or not _MINUTES.search(head[0].cell.source):
        yield author_text("no_minutes")
    task = next((place for place, one in enumerate(cells) if one.cell.kind is CellRole.SOLUTION), 0)
    if (before := _words(filter(_is_text, cells[:task]))) > _MAX_WORDS_BEFORE_A_TASK:
        yield author_text("late_task", words=before, most=_MAX_WORDS_BEFORE_A_TASK)


def _solutions(cells: Iterable[NamedCell]) -> Iterator[str]:
    for one in cells:
        if one.cell.kind is CellRole.SOLUTION:
            region = find_region(one.cell.source)
            # A repair keeps most lines of the broken code, which students get.
            written = sum(bool(line.strip()) for line in region.answer if line not in region.stub)
            if not (region.is_repair or written) or written > _MAX_SOLUTION_LINES:
                words = {"name": one.name, "line": one.cell.line, "written": written}
                yield author_text("large_task", **words, most=_MAX_SOLUTION_LINES)


def _introductions(cells: list[NamedCell]) -> Iterator[str]:
    for before, one in itertools.pairwise(cells):
        sentences = [
            line for line in before.cell.source.splitlines() if line.strip() and not line.startswith("#")
        ]
        # The task above a check says what it checks, and a cell that stops what runs says so itself.
        speaks_for_itself = one.check is not None or all(
            line.endswith(".stop()") for line in one.cell.source.splitlines()
        )
        if not (_is_text(one) or speaks_for_itself or (_is_text(before) and sentences)):
            yield author_text("bare_code", line=one.cell.line)


def _predictions(cells: list[NamedCell]) -> Iterator[str]:
    for before, one in itertools.pairwise(cells):
        # A cell that only defines or stops something has no result that a student could predict.
        shows = one.cell.source.startswith("%%bash") or "print(" in one.cell.source
        if one.cell.kind is CellRole.DEMONSTRATION and shows and _PREDICTION not in before.cell.source:
            yield author_text("no_prediction", line=one.cell.line)


def _tasks(cells: list[NamedCell]) -> Iterator[str]:
    for before, one in itertools.pairwise(cells):
        if one.cell.kind is CellRole.SOLUTION and _is_text(before):
            for paragraph in _PARAGRAPH.split(_FOLD.sub("", before.cell.source)):
                if len(_PARENTHESIS.findall(_CODE.sub("", paragraph))) > 1:
                    yield author_text("parentheses", line=one.cell.line)


def _self_checks(texts: Iterable[NamedCell]) -> Iterator[str]:
    for one in texts:
        for found in _SELF_CHECK.finditer(one.cell.source):
            replies = _REPLY.findall(found["choices"])
            if set(replies) != {"✓", "✗"} or replies.count("✓") > 1:
                yield author_text("other_replies", line=one.cell.line)


def _end(cells: list[NamedCell]) -> Iterator[str]:
    if not cells or "https://docs.ros.org/en/jazzy/" not in cells[-1].cell.source:
        yield author_text("no_closing_link")


def _is_text(one: NamedCell) -> bool:
    return one.cell.kind is CellRole.TEXT


def _words(cells: Iterable[NamedCell]) -> int:
    return len(_FOLD.sub("", _PICTURE.sub("", "\n".join(one.cell.source for one in cells))).split())
