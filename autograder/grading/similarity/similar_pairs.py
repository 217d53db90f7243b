"""Finds pairs of similar answers in a class, even if a student inserted lines into a copy or moved lines.

The result also lists the files that were not compared.
"""

from __future__ import annotations

from collections import Counter, defaultdict
from dataclasses import dataclass
from itertools import chain, combinations
from typing import TYPE_CHECKING

from rapidfuzz.distance import LCSseq

from autograder.grading.collecting.submitted_folder import misplaced_files
from autograder.grading.grading_errors import GradingError, check_known
from autograder.grading.similarity.own_words import LONGEST, SEQUENCE, GivenCode, compared_answers
from autograder.grading.similarity.student_answers import given_texts, read_answers
from autograder.grading.table.student_list import read_roster

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence
    from pathlib import Path

    from autograder.grading.classes.class_directory import ClassDirectory, RefusedFile
    from autograder.grading.similarity.own_words import ComparedAnswer


MOST_SHOWN = 100
"""The maximum number of pairs of students to show, the most similar first."""
SHORTEST = 40
"""Two answers are similar only if they share at least this number of students' own words: four to eight lines.

For comparison: two independent right answers in the bank share at most 27 such words.
"""
LEAST_SHARE = 0.5
"""Two answers are similar only if they share at least this fraction of the words that the student of the shorter answer
wrote. Given code does not count.
"""
_ROUNDS = 6
"""The number of times that two answers are compared. The first comparison finds passages that have the same order in
both answers. Each further comparison ignores the passages found before, and so finds moved passages.
"""
_FOUND_IN_ONE, _FOUND_IN_OTHER = -3, -4

HINT = (
    "A pair is a hint, not a proof: two students may have learned from each other, or from the same web page. "
    "Read both answers, and talk with both students, before you decide anything."
)
"""The text that is shown with every list of pairs."""


@dataclass(frozen=True)
class SimilarPairs:
    """The result of a search for similar answers in a class.

    Attributes:
        path: The class.
        pairs: The similar pairs of answers, the most similar first.
        more: The number of pairs of students that are left out of ``pairs``.
        names: The students' names, by id.
        compared: The number of submitted notebooks that were compared.
        notes: Sentences for the instructor that are not about a failure.
        troubles: A line for each file that was not compared, or only in part.
    """

    path: Path
    pairs: tuple[Pair, ...]
    more: int
    names: Mapping[str, str]
    compared: int
    notes: tuple[str, ...]
    troubles: tuple[str, ...]

    @property
    def exit_code(self) -> int:
        """The command's exit code: 0 if every file was compared, even if there are similar pairs; otherwise 2."""
        return 2 if self.troubles else 0


def find_similar(directory: ClassDirectory, assignment: str = "") -> SimilarPairs:
    """Compare the submissions of a class with each other.

    Args:
        assignment: The assignment whose submissions are compared; all assignments if empty.

    Raises:
        GradingError: No submission exists, the assignment does not exist, or a source notebook cannot be used.
    """
    assignments = directory.assignments()
    check_known([assignment] if assignment else [], assignments, "assignment")
    submissions, refused = directory.submissions()
    submissions = [one for one in submissions if assignment in ("", one.assignment)]
    troubles = list(_refused_lines(directory, refused, assignment))
    if not submissions and not troubles:
        raise GradingError(
            f"The class has no submissions yet{f' for {assignment}' if assignment else ''}, so nothing can be compared."
        )
    # From all assignments: code that another lab gives is not the student's own either.
    given = GivenCode(given_texts(directory))
    pairs: list[Pair] = []
    notes = []
    read = 0
    for name in [assignment] if assignment else assignments:
        for notebook in directory.notebooks(name):
            handed_in = read_answers(
                directory, name, notebook, [one for one in submissions if one.assignment == name]
            )
            read += len(handed_in.students)
            troubles += handed_in.troubles
            if len(handed_in.students) == 1:
                notes.append(
                    f"{notebook}: only one student has submitted this notebook, so there is nothing to compare."
                )
            answers = compared_answers(handed_in.answers, given, len(handed_in.students))
            troubles += [
                f"left out     {one.answer.student}/{name}: {one.answer.cell} is too long; only its "
                f"first {LONGEST} words were compared"
                for one in answers
                if one.is_cut
            ]
            pairs += _close_pairs(answers)
    groups = by_students(sorted(pairs, key=_rank))
    students = read_roster(directory).students
    return SimilarPairs(
        directory.path,
        tuple(chain.from_iterable(groups[:MOST_SHOWN])),
        len(groups[MOST_SHOWN:]),
        {id_: student.name for id_, student in students.items() if student.name},
        read,
        tuple(notes),
        tuple(troubles),
    )


def _refused_lines(
    directory: ClassDirectory, refused: Iterable[RefusedFile], assignment: str
) -> Iterator[str]:
    """Yield a line for each file that cannot be used because it is refused or lies in a wrong folder."""
    for one in (*refused, *misplaced_files(directory)[0]):
        # A file above the assignment's folder may belong to any assignment.
        below = one.path.relative_to(directory.path / "submitted").parts[1:]
        if not assignment or not below or below[0] == assignment:
            yield f"refused      {one.path}: {one.reason}"


@dataclass(frozen=True)
class Passage:
    """A part of two answers that has the same words in the same order.

    Attributes:
        first: The index of the passage's first word in the first answer.
        second: The index of the passage's first word in the second answer.
        own: For each word of the passage, True if the word is the student's own in both answers.
    """

    first: int
    second: int
    own: tuple[bool, ...]


@dataclass(frozen=True)
class Pair:
    """Two similar answers.

    Attributes:
        passages: The common passages, in the order of the first answer.
    """

    one: ComparedAnswer
    other: ComparedAnswer
    passages: Sequence[Passage]

    @property
    def shared(self) -> int:
        """The number of students' own words in the common passages."""
        return sum(sum(passage.own) for passage in self.passages)

    @property
    def share(self) -> float:
        """The fraction of the shorter answer that is in the common passages, counting only the student's own words."""
        return self.shared / min(self.one.length, self.other.length)

    @property
    def percent(self) -> str:
        """The share in percent as text, rounded down, so that only a share of all words is ``100 %``."""
        return f"{int(100 * self.share)} %"

    @property
    def students(self) -> tuple[str, str]:
        """The ids of the two students."""
        return self.one.answer.student, self.other.answer.student

    @property
    def place(self) -> str:
        """The notebook and the cells of the two answers, as text."""
        cells = dict.fromkeys((self.one.answer.cell, self.other.answer.cell))
        return f"{self.one.answer.notebook}, {' and '.join(cells)}"


def by_students(pairs: Iterable[Pair]) -> list[list[Pair]]:
    """Return the pairs grouped by students: each group contains the pairs of the same two students."""
    groups: dict[tuple[str, str], list[Pair]] = {}
    for pair in pairs:
        groups.setdefault(pair.students, []).append(pair)
    return list(groups.values())


def nothing_found(notebooks: int) -> str:
    """Return the sentence to show if no pairs are similar in this number of compared notebooks."""
    return f"No two answers are more similar than their task explains ({notebooks} notebooks compared)."


def _close_pairs(answers: Sequence[ComparedAnswer]) -> list[Pair]:
    """Return the similar pairs of answers to one notebook.

    Each cell of a student is compared with all cells of the other students, because a student may have moved a copy
    into an added cell.
    """
    candidates = _candidates([answer for answer in answers if answer.length >= SHORTEST])
    pairs = [Pair(left, right, _common_passages(left, right)) for left, right in candidates]
    return [pair for pair in pairs if pair.shared >= SHORTEST and pair.share >= LEAST_SHARE]


def _candidates(answers: Sequence[ComparedAnswer]) -> list[tuple[ComparedAnswer, ComparedAnswer]]:
    """Return the pairs that share enough sequences to be similar: only these are then compared fully, to save time.

    No similar pair is lost, because two answers that share ``SHORTEST`` own words share at least ``SHORTEST //
    SEQUENCE`` sequences.
    """
    holders: defaultdict[tuple[str, ...], list[int]] = defaultdict(list)
    for index, answer in enumerate(answers):
        for sequence in answer.sequences:
            holders[sequence].append(index)
    meetings = Counter(pair for indexes in holders.values() for pair in combinations(indexes, 2))
    return [
        (answers[left], answers[right])
        for (left, right), sequences in sorted(meetings.items())
        if sequences >= SHORTEST // SEQUENCE and answers[left].answer.student != answers[right].answer.student
    ]


def _common_passages(one: ComparedAnswer, other: ComparedAnswer) -> list[Passage]:
    """Return the common passages of two answers, in the order of the first answer.

    A passage that consists only of given code is left out.
    """
    numbers = {sign: number for number, sign in enumerate({*one.signs, *other.signs})}
    first, second = ([numbers[sign] for sign in answer.signs] for answer in (one, other))
    passages: list[Passage] = []
    for _ in range(_ROUNDS):
        blocks = [
            (block.src_start, block.dest_start, block.src_end - block.src_start)
            for block in LCSseq.opcodes(first, second)
            if block.tag == "equal" and block.src_end - block.src_start >= SEQUENCE
        ]
        if not blocks:
            break
        for start, other_start, length in blocks:
            # Replace the passage by one number in the first answer and by another in the second, so that no later
            # comparison finds the passage again.
            first[start : start + length] = [_FOUND_IN_ONE] * length
            second[other_start : other_start + length] = [_FOUND_IN_OTHER] * length
            sides = zip(
                one.own[start : start + length], other.own[other_start : other_start + length], strict=True
            )
            passages.append(Passage(start, other_start, tuple(left and right for left, right in sides)))
    return sorted((passage for passage in passages if any(passage.own)), key=lambda passage: passage.first)


def _rank(pair: Pair) -> tuple[object, ...]:
    """Return a key that sorts pairs by similarity, the most similar first, and equally similar pairs by name."""
    answer = pair.one.answer
    names = (answer.assignment, *pair.students, answer.cell)
    return -round(pair.share, 2), -pair.shared, names
