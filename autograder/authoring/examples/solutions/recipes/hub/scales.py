"""A hub: two topics in, one out, and a service that changes what is published."""

from collections.abc import Sequence

from autograder.kit.recipes.relay import SILENCE, WHOLE, Hub, Reply, To

LEFT, RIGHT, TARE = "/left", "/right", "/tare"
PUT = (TARE, LEFT, LEFT, RIGHT, RIGHT, LEFT, TARE, LEFT, RIGHT, TARE, RIGHT, LEFT)


def due(
    given: Sequence[To],
    start: int | None = None,
    counts: bool = True,
    net: bool = False,
    always: bool = False,
) -> object:
    """Return what is due after the last input: the total of both scales, or the reply to the call."""
    newest, tared, out = {LEFT: start, RIGHT: start}, 0, SILENCE
    for name, value in given:
        if name != TARE:
            newest[name] = value
        loads = [load for load in newest.values() if load is not None]
        ready, total = len(loads) == len(newest), sum(loads)
        if name == TARE:
            out = Reply({"success": ready or always})
            tared = total - (tared if net else 0) if ready and counts else tared
        else:
            out = total - tared if ready else SILENCE
    return out


task = Hub(
    "hub.scales",
    "Two topics and a service · The scales",
    "Publish the sum of two scales, less what was tared.",
    field="data",
    due=due,
    gives=[To(name, {} if name == TARE else WHOLE) for name in PUT],
    roles=("subscription", "publisher", "service"),
)
task.asks("hears", 1, "Subscribes to both topics", "subscription", "Subscribe to `/left` and to `/right`")
task.asks("speaks", 1, "Publishes on the right topic", "publisher", "Publish `Int32` on `/total`")
task.asks("serves", 1, "Serves the right service", "service", "Offer the service `/tare`")
task.answers("totals", 5, "Publishes each total", "publish the sum of the newest weights of both scales")
task.replies("success", 2, "Says whether it tared", "Let `success` be true, or false")

BOTH = "Begin with None for each weight, and publish nothing while one of them is None."
task.wrong("missing_taken_for_zero", {"start": 0}, "Your node adds a weight that did not come yet.", BOTH)
KEEP = "Keep self.left + self.right, without what was tared before, and take it away from each sum."
task.wrong(
    "tare_ignored", {"counts": False}, "Your node publishes the whole sum after /tare was called.", KEEP
)
task.wrong("tare_of_net", {"net": True}, "At the second call of /tare your node keeps the last total.", KEEP)
task.wrong("always_success", {"always": True}, "Your node says success before there is a load.", BOTH)
for side in (LEFT, RIGHT):
    task.wrong(
        "one_side_only",
        lambda given, side=side: SILENCE if given[-1].name == side else due(given),
        f"Your node publishes nothing when a weight comes on {side}.",
        "Publish in the callbacks of both subscriptions.",
    )
EXERCISE = task.exercise()
