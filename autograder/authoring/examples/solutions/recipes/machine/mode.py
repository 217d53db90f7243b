"""A mode, declared: how the machine steps, and what wrong machines answer."""

from typing import Any

from autograder.kit.recipes.machine import SOME_TEXT, Machine


def step(mode: bool, asked: bool, refusal: Any = SOME_TEXT) -> tuple[bool, dict[str, Any]]:
    """Return the new mode and the reply: a request without a change is refused, with any text."""
    return asked, {"success": True} if asked != mode else {"success": False, "message": refusal}


task = Machine(
    "machine.mode",
    "A mode · The service",
    "Set a mode by a service, and tell of each change.",
    state=False,
    step=step,
)
task.replies(
    "success", 4, "Says success only if the mode changes", "`success` is true where the mode changes"
)
task.replies("message", 2, "Says why it refuses", "`message` says why")
task.once_at_each_change("once", 2, "Tells of each change once", "once at each change")
task.late_joiner_gets_the_last(
    "late", 2, "Tells a late listener the last mode", "who subscribes later hears the last one"
)

task.not_latched()
task.wrong(
    "never_refused",
    lambda _, asked: (asked, {"success": True}),
    "Your node says success although the mode does not change.",
    "Compare request.data with self.mode first; if they are equal, let success be False.",
)
REASON = "Say why: response.message = …"
task.wrong("refused_without_message", {"refusal": ""}, "Your node refuses without a message.", REASON)
task.wrong(
    "success_forgotten",
    lambda _, asked: (asked, {"success": False}),
    "Your node never says success.",
    "If the mode was changed, write response.success = True.",
)
task.told_too_often("told_without_change")
EXERCISE = task.exercise()
