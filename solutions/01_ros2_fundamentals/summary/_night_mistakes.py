"""Known mistakes on patrol, most telling first, and what to do about them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from summary._night import commands, goals, lamps, near_messages

from autograder.kit.mistakes.unfinished import STEP_MISSING
from autograder.kit.rules import another_rate

if TYPE_CHECKING:
    from collections.abc import Callable

    from autograder.kit.evidence import Part

MISTAKES: tuple[tuple[str, Callable[[Part, Part], object], str, str, dict[str, Any]], ...] = (
    (
        "wrong_movement",
        lambda seen, expected: next((told for told in commands(seen) if told not in commands(expected)), ""),
        "A command of yours says {}; the task asks for linear.x = 0.4, angular.z = 1.",
        "Make a new Twist() for each command, and set command.linear.x and command.angular.z before you publish it.",
        {"certain": True},
    ),
    (
        "cancel_repeated",
        lambda seen, _: len(seen.of("cancel")) > 1 and len(seen.of("cancel")),
        "Your node asked {} times to cancel its walk: feedback goes on for a moment after the first request.",
        "Remember that you have asked: set the goal handle to None after the request, and ask only if it is not None.",
        {"certain": True},
    ),
    (
        "cancel_too_early",
        lambda seen, _: seen.of("cancel") and not near_messages(seen),
        "Your node asked to cancel its walk when one metre or more was left.",
        "Compare the distance that the feedback brings, and do not count messages: if distance < 1.0.",
        {},
    ),
    (
        "cancel_too_late",
        lambda seen, _: seen.of("cancel") and near_messages(seen) > 1,
        "Your node let a feedback message below one metre pass before it asked to cancel its walk.",
        "Ask at the first such message: if distance < 1.0.",
        {},
    ),
    (
        "cancel_missing",
        lambda seen, _: seen.of("result") and not seen.of("cancel"),
        "Your node never asked to cancel its walk, although less than one metre was left.",
        "Keep the goal handle, which is the answer to the goal, and call its cancel_goal_async(), with parentheses, "
        "if distance < 1.0. If no feedback arrives, pass feedback_callback=... to send_goal_async.",
        {"late": True},
    ),
    (
        "wrong_rate",
        another_rate,
        "Your commands come {}; the task asks for two a second.",
        "Give create_timer the period in seconds, 0.5, and leave time.sleep out of the callback.",
        {},
    ),
    (
        "not_written",
        lambda seen, _: (
            commands(seen) and not goals(seen) and ("goal" if lamps(seen) else "call of the lamp")
        ),
        "Your node drives, and no {} came after that.",
        STEP_MISSING,
        {"late": True},
    ),
)
"""The arguments of ``Draft.knows``."""
