"""A ticket of a bug hunt: a data file for two exercises, the repair and the question on the cause.

The file ``dark_display.ticket.toml`` contains all words of the exercises ``dark_display`` and ``dark_display_why``, so
that a new ticket needs no code.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import msgspec

from autograder import packed_files
from autograder.course import CAUSE, TICKET
from autograder.kit.hunts.question import Question
from autograder.kit.hunts.repairs import Repairs

if TYPE_CHECKING:
    from pathlib import Path

    from autograder.kit.model import Exercise


class Ticket(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """The words of a ticket, none of which a student sees before the pass except title, task, question and choices.

    Attributes:
        title: The title of the card, such as ``"Bug hunt 1 · The dark display"``, which must not tell the cause.
        task: What the repaired program does. The text of the lab contains this sentence.
        judged_by: The id of the exercise that judges the repaired program. The broken one must fail it.
        cause: The cause in two sentences.
        sooner: How the student would have found it sooner, in a sentence.
        seen: A sentence about a real project in which it happened, and the address of its public issue.
        question: The question on the cause. The text of the lab contains it.
        right: The right choice.
        choices: All choices, or only the wrong ones.
    """

    title: str
    task: str
    judged_by: str
    cause: str
    sooner: str
    seen: str
    question: str
    right: str
    choices: tuple[str, ...]


def exercise_of(file: Path) -> Exercise:
    """Return an exercise of a ticket: the repair of its broken program or, for a name in ``_why``, the question.

    Args:
        file: The path that the exercise's own file would have, next to the ticket.

    Raises:
        ValueError: The ticket cannot be read, lacks a field, or has an unknown one; or a choice is wrong.
    """
    exercise_id, name = f"{file.parent.name}.{file.stem}", file.stem.removesuffix(CAUSE)
    words = file.with_name(f"{name}{TICKET}")
    try:
        ticket = msgspec.toml.decode(packed_files.read(words), type=Ticket)
    except (OSError, ValueError, EOFError) as error:
        fields = ", ".join(Ticket.__struct_fields__)
        raise ValueError(f"{words.name}: {error}. A ticket has the fields {fields}") from error
    if name != file.stem:
        title = f"{ticket.title} · Why"
        return Question(exercise_id, title, ticket.question, ticket.right, ticket.choices).exercise()
    after = (
        f"The cause: {ticket.cause}",
        f"Sooner next time: {ticket.sooner}",
        f"In real projects: {ticket.seen}",
    )
    return Repairs(exercise_id, ticket.title, ticket.task, ticket.judged_by, after).exercise()
