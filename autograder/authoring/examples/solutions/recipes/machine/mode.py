"""A mode, declared: how the machine steps, what is asked of it, and when somebody comes late."""

from autograder.kit.recipes.declared import SOME_TEXT, Machine


def step(mode: bool, asked: bool) -> tuple[bool, dict[str, object]]:
    """The new mode and the reply: what is no change is refused, with any text."""
    return asked, {"success": True} if asked != mode else {"success": False, "message": SOME_TEXT}


task = Machine(
    "machine.mode",
    "A mode · The service",
    "Set a mode by a service, and tell of each change.",
    state=False,
    step=step,
    asks=(False, True, True, False, False, True, True, False, False, True, False),
    late_after=6,
)
task.replies(
    "success",
    4,
    "Answers success where the mode changes, and only there",
    "success",
    words="`success` is true where the mode changes",
)
task.replies(
    "refuses", 2, "Says why it refuses", "message", lambda call: not call.changed, "`message` says why"
)
task.once_at_each_change("once", 2, "Tells of each change once", "once at each change")
task.late_joiner_gets_the_last(
    "late", 2, "Tells a late listener the last mode", "who subscribes later hears the last one"
)

task.not_latched(
    "not_latched",
    "Your publisher keeps no message: who subscribes after it was published hears nothing.",
    "Give create_publisher QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL) in place of 10.",
)
task.wrong(
    "never_refused",
    lambda _, asked: (asked, {"success": True}),
    "Your node says success where the mode is already so.",
    "Compare request.data with self.mode first; where they are equal, let success be False.",
)
task.wrong(
    "refused_without_message",
    lambda mode, asked: (asked, {"success": asked != mode, "message": ""}),
    "Your node refuses without a message.",
    "Say why: response.message = …",
)
task.wrong(
    "success_forgotten",
    lambda _, asked: (asked, {"success": False}),
    "Your node never says success.",
    "Where the mode was changed, response.success = True.",
)
task.told_too_often(
    "told_without_change",
    "Your node publishes more often than the mode changes.",
    "Publish in the method of the service only, and only where the mode is another one.",
)
EXERCISE = task.exercise()
