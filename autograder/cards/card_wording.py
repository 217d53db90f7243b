"""The words that both kinds of card use, so that HTML and text never say different things."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from typing import TYPE_CHECKING

from autograder.cards.readable_text import TRACEBACK, last_error, one_line
from autograder.verdict import NO_RESULT, State

if TYPE_CHECKING:
    from autograder.cards.card_traffic import Traffic, TrafficPart
    from autograder.verdict import CriterionResult, Moment, Verdict


STATE_WORDS = {
    State.PASSED: "Passed",
    State.FAILED: "Not yet",
    State.NOT_CHECKED: "Could not be checked",
    State.CHECKING: "Checking",
}

DIRECTION_WORDS = {
    "from_subject": "from your code",
    "to_subject": "to your code",
    "note": "note",
    "expected": "expected, and did not come",
}

CRITERION_WORDS = {True: "PASS", False: "NOT YET", None: "TO COME"}

DIFFERENCE = "the difference ([ ] is missing, { } is too much)"

ASKED = "What is asked"
"""The heading of the criteria on a card before anything of the student's code was seen."""
COUNTS = "what counts"
"""The label of what else is accepted for a criterion."""
COUNTS_BESIDES = "what else counts, and what does not"
"""The label of the same about the exercise as a whole."""

WAY = "The robot's path"
"""The heading of the pictures of a robot's way."""

SOLUTION = "The reference solution, and why it is written so"
"""The heading of the folded reference solution."""
OFFER = (
    "You have tried this task in several ways. If its last hint does not help either, you can open the worked "
    "solution. Your progress then says “with the worked solution”."
)
"""What a card says beside the button that opens the worked solution."""
OUR_CHANGE, OWN_CHANGE = "Our repair", "Your repair"
"""The headings of two ways in which broken code was changed."""
OTHER_WAY = "Another way"
"""The heading of an alternative to the reference solution."""

_BLAMELESS = (
    "The checker itself had trouble: the missing result is not your mistake, and no points were counted."
)
_TRY_AGAIN = "Run the check again. If this card comes back, show it to your instructor."


@dataclass(frozen=True)
class AdviceBlock:
    """The prominent block of a card, which says what happened and what to do now.

    Attributes:
        heading: The heading, such as ``"What happened"``; empty if the text needs none.
        text: One to three sentences.
        next_step: What to do now, in the imperative; empty if there is nothing left to do.
    """

    heading: str
    text: str
    next_step: str = ""


def advice(verdict: Verdict) -> AdviceBlock:
    """Return the advice that a student should read first. There is always some, even if the mistake is unknown."""
    if verdict.state is State.PASSED:
        return AdviceBlock("", "Well done: your code did everything that was asked for.")
    diagnosis = verdict.diagnosis
    if verdict.state is State.CHECKING:
        return AdviceBlock("", diagnosis.text if diagnosis else "")
    if verdict.state is State.NOT_CHECKED:
        reason = diagnosis.text.strip() if diagnosis else ""
        next_step = diagnosis.next_step.strip() if diagnosis else ""
        if not diagnosis or diagnosis.key == NO_RESULT:
            reason = f"{reason} {_BLAMELESS}".lstrip()
        return AdviceBlock("Why there is no result", reason, next_step or _TRY_AGAIN)
    first = next((criterion for criterion in verdict.criteria if not criterion.passed), None)
    if diagnosis:
        return AdviceBlock("What happened", diagnosis.text, diagnosis.next_step.strip() or _start_with(first))
    return AdviceBlock("What happened", "Not everything that was asked for was seen.", _start_with(first))


def _start_with(criterion: CriterionResult | None) -> str:
    if criterion is None:
        return "Read the details below, change your code and run the check again."
    title = criterion.title.rstrip(". ")
    return f'Start with "{title}": compare what was expected with what was seen, then run the check again.'


def points(value: float) -> str:
    """Return a number of points without unnecessary zeros: ``"7.5"``, ``"10"``."""
    return f"{value:.2f}".rstrip("0").rstrip(".")


def unit(value: float) -> str:
    """Return the word after a number of points: "point" or "points"."""
    return "point" if value == 1 else "points"


def points_of(earned: float, possible: float) -> str:
    """Return ``"7.5 of 10 points"``."""
    return f"{points(earned)} of {points(possible)} {unit(possible)}"


def score_line(verdict: Verdict, before: float | None = None) -> str:
    """Return the points in words. If the check could not be made, the words differ from those for zero points.

    Args:
        before: The points of the previous check; None if there was none.
    """
    if verdict.state is State.NOT_CHECKED:
        return f"no points counted (of {points(verdict.max_score)})"
    earlier = points_before(verdict, before)
    return points_of(verdict.score, verdict.max_score) + (f", {earlier} before" if earlier else "")


def points_before(verdict: Verdict, before: float | None) -> str:
    """Return the points of the previous check in words if they were different; otherwise an empty text."""
    if before is None or verdict.state is State.NOT_CHECKED or before == verdict.score:
        return ""
    return points(before)


def with_solution(tasks: int) -> str:
    """Return ``"2 tasks with the worked solution"``; empty for no task."""
    return f"{tasks} task{'' if tasks == 1 else 's'} with the worked solution" if tasks else ""


def tally(verdict: Verdict) -> str:
    """Return how many criteria are met, such as ``"3 of 4 criteria hold"``; empty if there are no criteria."""
    if not verdict.criteria:
        return ""
    held = sum(criterion.passed is True for criterion in verdict.criteria)
    total = len(verdict.criteria)
    if verdict.state is State.CHECKING:
        return f"{held} of {total} decided"
    if total == 1:
        return f"{held} of 1 criterion holds"
    if held == total:
        return "both criteria hold" if total == 2 else f"all {total} criteria hold"
    return f"{held} of {total} criteria hold"


def fine_print(verdict: Verdict) -> list[str]:
    """Return the facts to quote in a question or an appeal: exercise id, diagnosis, seed and duration of the check."""
    parts = [verdict.exercise]
    if verdict.diagnosis and not verdict.diagnosis.hidden:
        parts.append(verdict.diagnosis.key)  # docs/mistakes.md has a heading with this key
    if verdict.seed:
        parts.append(f"seed {verdict.seed}")
    if verdict.seconds > 0:
        parts.append(f"checked in {duration(verdict.seconds)}")
    return parts


def duration(seconds: float) -> str:
    """Return a duration such as ``"0.84 s"`` or ``"12.3 s"``."""
    return f"{seconds:.2f} s" if seconds < 10 else f"{seconds:.1f} s"


def detail_heading(detail: str) -> str:
    """Return the heading above a traceback or output. For a traceback, it contains the exception."""
    if TRACEBACK in detail:
        return f"The traceback, ending in: {last_error(detail)}"
    return "The last lines of output"


def traffic_notes(shown: Traffic) -> str:
    """Return notes on the traffic that is shown: its kind of time, and what is left out."""
    notes = []
    if shown.simulated:
        notes.append("Simulated time: the judge moved your node's clock, so these seconds pass faster.")
    if shown.left_out:
        count = "1 moment is" if shown.left_out == 1 else f"{shown.left_out} moments are"
        notes.append(f"{count} left out in the middle, because there is too much to show.")
    if shown.parts_left_out:
        count = "1 more run is" if shown.parts_left_out == 1 else f"{shown.parts_left_out} more runs are"
        notes.append(f"{count} not shown.")
    return " ".join(notes)


def direction(key: str) -> str:
    """Return a moment's direction in words."""
    return DIRECTION_WORDS.get(key) or one_line(key, 40)


def moment_in_words(moment: Moment, when: str) -> str:
    """Return a moment in words, such as ``"at 0.500 s on chatter, from your code: Hello, world! 0"``.

    Args:
        when: The time of the moment; if all times are the same, its number.
    """
    where = one_line(moment.lane, 60)
    at = when if when.startswith("no.") else f"at {when}"
    return f"{at} on {where}, {direction(moment.direction)}: {one_line(moment.label, 200)}"


def part_in_words(part: TrafficPart) -> str:
    """Return the content of a picture in words, one sentence for each lane."""
    return " ".join(_lane_in_words(part, lane) for lane in part.lanes)


def _lane_in_words(part: TrafficPart, lane: str) -> str:
    members = [index for index, moment in enumerate(part.moments) if moment.lane == lane]
    counts = Counter(direction(part.moments[index].direction) for index in members)
    listed = ", ".join(f"{count} {words}" for words, count in counts.items())
    times = part.when(members[0])
    if len(members) > 1:
        times = f"from {times} to {part.when(members[-1])}"
    elif not part.stands_still:
        times = f"at {times}"
    return f"{one_line(lane, 60)}: {listed}, {times}."
