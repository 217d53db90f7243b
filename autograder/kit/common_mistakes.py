"""Mistakes that several exercises share, recognized from the graph and from the way the subject ended."""

from __future__ import annotations

import difflib
from collections import Counter
from itertools import pairwise
from typing import TYPE_CHECKING

import re2

from autograder.kit.crashes import CRASHES, OTHER_CRASHES, traceback_of
from autograder.kit.giving_up import ended_at_once
from autograder.kit.hangs import something_spins
from autograder.kit.model import Advice, Mistake, mistake
from autograder.kit.texts_said import said_first_after
from autograder.kit.workspace_report import report_of

if TYPE_CHECKING:
    from collections.abc import Mapping

    from autograder.kit.evidence import Evidence, Part

__all__ = [
    "AWAITS_IN_VAIN",
    "CRASHES",
    "NEVER_CONSTRUCTED",
    "NOTHING_THERE",
    "NOT_BEGUN",
    "OTHER_CRASHES",
    "STEP_MISSING",
    "USAGE_MESSAGE",
    "ended_too_early",
    "endpoint_name",
    "everything_twice",
    "message_type",
    "never_spun",
    "only_if_ended",
    "qos_mismatch",
    "servers",
    "twin",
    "two_servers",
    "went_deaf",
]

_WORD = {
    "publisher": ("publishes on", "topic"),
    "subscription": ("subscribes to", "topic"),
    "client": ("asks for the service", "service"),
    "service": ("serves", "service"),
    "action_client": ("asks for the action", "action"),
    "action_server": ("serves the action", "action"),
}
_KEY = {"topic": "topic_name", "service": "service_name", "action": "action_name"}
STEP_MISSING = (
    "Find the TODO in your code and write that step. In a notebook, hints below the cell open one at a time."
)
"""The advice if a step of the task is not written yet."""


def _wanted(evidence: Evidence, role: str) -> Mapping[str, str]:
    """Return the reference's endpoints of a role, of which there is at least one: name -> type."""
    evidence.reference.only(role)
    return evidence.reference.interface[role]


def endpoint_name(role: str) -> Mistake:
    """An expected name is not on the graph, but another one of the same role is."""
    verb, noun = _WORD[role]

    def recognise(evidence: Evidence) -> Advice | None:
        wanted = _wanted(evidence, role)
        made: set[str] = set().union(*(part.endpoints(role) for part in evidence))
        missing, strange = sorted(wanted.keys() - made), made - wanted.keys()
        if not missing or not strange:
            return None
        near = difflib.get_close_matches(missing[0], strange, n=1, cutoff=0.0) or sorted(strange)
        return Advice(
            f"Your node {verb} {near[0]}; the {noun} is called {missing[0]}.",
            f"Compare the names letter by letter: two nodes are connected only if they are equal, as `ros2 {noun} "
            "list` shows them. A ~/ or a namespace in front comes from your code or your launch file: leave it out.",
        )

    return Mistake(_KEY[noun], recognise, certain=True)


def message_type(role: str) -> Mistake:
    """The name is right, but the type is wrong."""

    def recognise(evidence: Evidence) -> Advice | None:
        wanted, made = _wanted(evidence, role), evidence.main.endpoints(role)
        name = next((name for name in sorted(wanted) if made.get(name, wanted[name]) != wanted[name]), None)
        if name is None:
            return None
        expected = wanted[name]
        return Advice(
            f"On {name} your node uses {made[name]}; the other side uses {expected}. With two types for one name, "
            "nothing is connected.",
            f"Import and use {expected.split('/')[-1]} from {expected.split('/')[0]}.{expected.split('/')[1]}.",
        )

    return Mistake("message_type", recognise, certain=True)


def qos_mismatch(role: str) -> Mistake:
    """The QoS settings of the two ends are not compatible."""

    def recognise(evidence: Evidence) -> Advice | None:
        mismatches = [
            event for name in sorted(_wanted(evidence, role)) for event in evidence.main.of("mismatch", name)
        ]
        mismatch = next((event for event in mismatches if not evidence.main.of("message", event.name)), None)
        if mismatch is None:
            return None
        policy = mismatch.data["policy"]
        return Advice(
            f"Your node and the other side are both on {mismatch.name}, but their {policy} is not compatible, so "
            "no message arrives.",
            "Use the queue depth 10 in place of the QoS profile: that is reliable and volatile, as the other side is.",
        )

    return Mistake("qos_mismatch", recognise, certain=True)


def servers(part: Part) -> int:
    """Return the largest number of servers that existed at the same time."""
    return max((int(event.data["count"]) for event in part.of("servers")), default=0)


def two_servers(role: str, comes_of_it: str, next_step: str) -> Mistake:
    """Two servers share the name.

    Args:
        role: ``service`` or ``action_server``.
        comes_of_it: The consequence for a call or a goal, as a sentence.
        next_step: What to do.
    """

    def recognise(evidence: Evidence) -> Advice | None:
        count, (name, _) = servers(evidence.main), evidence.reference.only(role)
        said = f"{count} servers of {name} are on the graph. {comes_of_it}"
        return Advice(said, next_step) if count > 1 else None

    return Mistake("two_servers", recognise, certain=True)


def everything_twice(role: str) -> Mistake:
    """Each message arrives twice, because two nodes do the same work."""

    def recognise(evidence: Evidence) -> Advice | None:
        name, _ = evidence.reference.only(role)
        messages = evidence.main.of("message", name)
        heard = [str(event.data["fields"]) for event in messages]
        times = Counter(heard)
        pairs = [times[text] for text in heard[:-1]]
        if len(heard) < 4 or sum(count == 2 for count in pairs) < len(pairs) * 0.7:
            return None
        # Each publisher numbers its own messages. If a single publisher repeats a text much later, it counts in a
        # circle.
        numbers = [event.data.get("number") for event in messages]
        if len(set(numbers)) == len(numbers) and sum(a == b for a, b in pairwise(heard)) < len(heard) // 3:
            return None
        return Advice(
            "Every message arrives twice: two of your nodes (or two timers) do the same work.",
            "Make the node once. In a notebook, an earlier run of the cell may have left a node of its own.",
        )

    return Mistake("everything_twice", recognise, certain=True)


def never_spun(role: str) -> Mistake:
    """The endpoint exists, but the node never did anything and does not answer."""

    def recognise(evidence: Evidence) -> Advice | None:
        part = evidence.main
        if not _silent_node(evidence, role) or _worked(part, role) or something_spins(part):
            return None
        return Advice(
            "The node is on the graph, but none of its callbacks is ever called: nothing spins it.",
            "In a program, call rclpy.spin(your_node) at the end of main(). In a notebook, `with spinning(your_node):` "
            "does it.",
        )

    return Mistake("never_spun", recognise)


def went_deaf(role: str) -> Mistake:
    """The node worked for a moment, then fell silent for good, although it still exists."""

    def recognise(evidence: Evidence) -> Advice | None:
        part = evidence.main
        # The subject's first actions may come before the judge can see them; a spinning node is always on the graph.
        if not _silent_node(evidence, role) or not (_worked(part, role) or something_spins(part)):
            return None
        return Advice(
            "Your node receives nothing any more: something took it away from its executor, it was never added to one, "
            "or a callback that is an `async def` awaits what never comes.",
            "Spin a node in one place only. rclpy.spin_once or spin_until_future_complete, called in a callback or "
            "beside another executor, takes the node away from that one for good. In a callback, await nothing that "
            "needs another callback of the same group.",
        )

    return Mistake("node_taken_from_executor", recognise)


def _awaits_in_vain(evidence: Evidence) -> bool:
    """True if the subject spins and never used the last answer, in a run that did not end."""
    return any(part.ending is None and something_spins(part) and _left_an_answer(part) for part in evidence)


def _left_an_answer(part: Part) -> bool:
    # A client that only sends a goal may spin on without a fault while its node answers.
    answers = part.of("response") + (part.of("goal_answered") if part.of("unanswered") else [])
    if not answers:
        return False
    last = max(answers, key=part.events.index)
    later = part.events[part.events.index(last) :]
    acts = {"request", "goal", "cancel", "result_request", "message"}
    return not said_first_after(last, part) and acts.isdisjoint(event.kind for event in later)


AWAITS_IN_VAIN = mistake(
    "await_in_same_group",
    _awaits_in_vain,
    "An answer came, and your node spins, but the code that waits for the answer never goes on: it waits for "
    "rclpy.spin(...), which does not come back, or it awaits inside a callback of the same callback group that the "
    "answer needs.",
    "Outside of callbacks, write rclpy.spin_until_future_complete(your_node, your_future, timeout_sec=5.0) in place of "
    "rclpy.spin(your_node): it comes back with the answer. In a callback, give the client a callback group of its own "
    "(ReentrantCallbackGroup or another MutuallyExclusive one), or go on in a function that you give to the "
    "add_done_callback(...) of the future.",
)
"""Checked after the hangs, and before the mistakes of a node that is not spun."""


def _silent_node(evidence: Evidence, role: str) -> bool:
    part = evidence.main
    there = _wanted(evidence, role).keys() & part.endpoints(role)
    return bool(there) and part.ending is None and bool(part.of("unanswered"))


def _worked(part: Part, role: str) -> bool:
    if part.of("message") or part.of("answered") or part.of("goal_answer"):
        return True
    sent = part.first("sent")
    return role == "subscription" and sent is not None and bool(part.said(after=sent))


_TWIN = re2.compile(
    r"\[rcl\.logging_rosout\]: Publisher already registered for (?:provided )?node name:? '([^']*)'"
)


def twin(part: Part) -> str:
    """Return the name that two nodes of the subject share, as rcl or the notebook reports it; empty without one."""
    made = part.first("subject", "constructed")
    found = (_TWIN.search(str(event.data["text"])) for event in part.of("output"))
    told = next((str(match[1]) for match in found if match), "")
    return told or str(made.data.get("twin", "") if made else "")


_IN_MAIN = "In main(), call rclpy.init(), make your node and spin it: rclpy.spin(your_node)."
_IN_MAIN_OF_A_SERVER = _IN_MAIN.replace("main(),", "main() of a server,")
_IN_MAIN_OF_A_CLIENT = (
    "In main() of a client, call rclpy.init(), then your function that sends the request or the goal and waits for the "
    "answer."
)
_BEGIN_AT_TODO = "If your code still has its TODO, begin there."


def _what_main_does(evidence: Evidence) -> str:
    """Return the calls that main() needs, for a server, a client or both, as the task asks."""
    roles = evidence.reference.interface.keys()
    client = _IN_MAIN_OF_A_CLIENT if roles & {"client", "action_client"} else ""
    if not client:
        return _IN_MAIN
    return f"{_IN_MAIN_OF_A_SERVER} {client}" if roles - {"client", "action_client"} else client


def _main_guard(evidence: Evidence) -> Advice | None:
    ending = evidence.main.ending
    if ending is None or ending.name != "exited" or ending.data.get("code") != 0 or evidence.main.said():
        return None
    if evidence.main.had_node:
        return None
    at_once = "The program ended at once, without a word and without a node:"
    if report_of(evidence.main) is not None:  # the program starts by its entry point, which calls main()
        return Advice(f"{at_once} its main() makes none.", f"{_what_main_does(evidence)} {_BEGIN_AT_TODO}")
    return Advice(
        f"{at_once} main() makes none, or nothing calls main().",
        f"{_what_main_does(evidence)} Python calls main() only if the file ends with "
        "`if __name__ == '__main__':` (two underscores on each side) and, indented below it, `main()`; `ros2 run` "
        "calls it in any case. "
        f"{_BEGIN_AT_TODO}",
    )


_USAGE = re2.compile(r"(?i)\b(?:usage|uso|utilisation|aufruf|benutzung|verwendung|gebruik)\s*:")


def _usage_message(evidence: Evidence) -> str:
    """Return the line in which a program explains its arguments, if it made no request; else empty."""
    if evidence.in_a_notebook:
        return ""
    told = [line for part in evidence for line in part.said() if _USAGE.search(line)]
    asked = any(part.of("request") or part.of("goal") for part in evidence)
    return told[0].strip() if told and not asked else ""


USAGE_MESSAGE = mistake(
    "usage_message",
    _usage_message,
    "Your program did not accept the arguments that it was called with: “{}”.",
    "Count them: sys.argv[0] is the program itself, so one argument makes len(sys.argv) 2, two make 3, and three make "
    "4. A negative number is a number, too.",
    certain=True,
)


_WORK = ("message", "request", "answered", "goal", "goal_answer", "matched")
"""The kinds of events that show that a program works."""


def ended_too_early(evidence: Evidence) -> Advice | None:
    """The subject ended by itself with work left, after it had said or done something."""
    ending = evidence.main.ending
    if ending is None or traceback_of(evidence) or _main_guard(evidence):
        return None
    code = ending.data.get("code")
    exited = f"ended by itself, with exit code {code}," if code else "ended by itself"
    how = {"exited": exited, "returned": "returned"}.get(ending.name, "ended")
    keep = (
        "Keep it alive while it has work to do, for example with rclpy.spin(your_node), above anything that ends it; "
        "exit() in a callback does, too."
    )
    if not any(part.said() or any(map(part.of, _WORK)) for part in evidence):
        return Advice(
            f"The program {how} and did nothing that the judge could see.", f"{_BEGIN_AT_TODO} {keep}"
        )
    roles = evidence.reference.interface.keys()
    if roles and roles <= {"client", "action_client"}:
        return None  # a client that did something may end when it likes: the criteria say what is missing
    asked = evidence.main.of("asked")
    is_open = len(asked) > len(evidence.main.of("answered"))
    when = f"when {asked[-1].name} was called, and no answer came" if is_open else "before its work was done"
    return Advice(f"The program {how} {when}.", keep)


def only_if_ended(mistake: Mistake) -> Mistake:
    """Return the same mistake, certain if each run of the subject ended by itself: then timing had no influence."""

    def recognise(evidence: Evidence) -> Advice | None:
        return mistake.recognise(evidence) if all(part.ending for part in evidence) else None

    return Mistake(mistake.key, recognise, certain=True)


def _not_written(evidence: Evidence) -> Advice | None:
    """The code runs, but an expected endpoint is missing: no endpoint at all, the wrong role, or one of several."""
    part = evidence.main
    if part.ending is not None and part.ending.name == "exited" and part.had_node:
        return None  # a program may end before the graph shows its endpoints
    nodes = any(survey.data.get("nodes") for survey in part.of("interface"))
    returned_silently = part.returned is not None and not part.said()
    wanted = evidence.reference.interface
    missing = [
        f"{verb} {name}"
        for role, (verb, _) in _WORD.items()
        for name in sorted(wanted.get(role, {}).keys() - part.endpoints(role))
    ]
    if not (nodes or returned_silently) or not missing:
        return None
    return Advice(f"Your code runs, but nothing of it {missing[0]} yet.", STEP_MISSING)


def _returned_silently(evidence: Evidence) -> Advice | None:
    """A function returned nothing, said nothing and requested nothing, in each run."""
    for part in evidence:
        if (
            part.returned is None
            or part.said()
            or any(part.of(kind) for kind in ("request", "goal", "message"))
        ):
            return None
    if not evidence.main.events:
        return None
    return Advice(
        "Your function returns nothing, at once, and calls no server: a step is not written yet.",
        STEP_MISSING,
    )


def _returned_at_once(evidence: Evidence) -> Advice | None:
    """The same, and the function did not wait either, although it was told how long: the rest is missing."""
    asked = any(part.of("called") or part.of("looked") for part in evidence)
    return None if asked or not all(map(ended_at_once, evidence)) else _returned_silently(evidence)


def _without_node(evidence: Evidence) -> str:
    """Return the beginning of a sentence about a subject without a node; empty if it had one."""
    if any(part.had_node or any(map(part.of, ("log", "request", "goal", "message"))) for part in evidence):
        return ""
    ending = evidence.main.ending
    ended = {"exited": "The program ended, and no", "returned": "Your function returned, and no"}
    return ended.get(ending.name, "No") if ending is not None else "No"


def _surely_without_node(evidence: Evidence) -> str:
    """The same, but empty for a function that returned: its node may have ended before the graph showed it."""
    return "" if evidence.main.returned is not None else _without_node(evidence)


def _never_constructed(part: Part) -> bool:
    """True if the constructor of a notebook's class never finished."""
    return part.first("subject", "never_constructed") is not None


def _works(part: Part) -> bool:
    return _worked(part, "subscription")


NEVER_CONSTRUCTED = mistake(
    "never_ended",
    lambda evidence: any(_never_constructed(part) and not _works(part) for part in evidence),
    "Your node is never finished: its __init__ has a loop without an end, or waits for something.",
    "Let __init__ only make what the node needs, and leave the work to callbacks: no loop and no wait in it.",
    certain=True,
)


def constructor_remark(evidence: Evidence) -> str:
    """Return a remark on a class that works in its constructor, which is right only in a program; else empty."""
    if not any(_never_constructed(part) and _works(part) for part in evidence):
        return ""
    return (
        "Your node works inside its __init__, which never comes to its end: the line that makes the node never comes "
        "to its end either. Let __init__ only make what the node needs, and leave the work to callbacks."
    )


NOT_BEGUN = Mistake("not_written", _returned_at_once, certain=True)
"""A function as it was handed out: checked before mistakes about how it calls, waits or gives up."""
NOTHING_THERE = (
    Mistake("not_written", _returned_silently, certain=True),
    Mistake("main_guard", _main_guard, certain=True),
    *(
        mistake(
            "nothing_on_the_graph",
            found,
            "{} node of yours appeared on the graph.",
            "In a program, call rclpy.init() in main(), then make your node (of your class, or with create_node) and "
            "spin it, which keeps the program running. In a notebook, make the node in your function (start_ros() has "
            "started ROS) and do all of the work before the function returns. If your code does that already, leave "
            "out domain_id and ROS_DOMAIN_ID: the judge looks for your node in the domain in which it was started.",
            certain=found is _surely_without_node,
        )
        for found in (_surely_without_node, _without_node)
    ),
    Mistake("not_written", _not_written),
    Mistake("ended_too_early", ended_too_early),
)
"""The mistakes that are checked last, if nothing more exact fits."""
