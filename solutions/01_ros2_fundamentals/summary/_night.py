"""One night with a robot that the judge plays: a round, a lamp that takes a while to answer, and one walk."""

from __future__ import annotations

from typing import TYPE_CHECKING

from autograder.kit.in_words import counted
from autograder.kit.rules import values

if TYPE_CHECKING:
    from collections.abc import Sequence

    from autograder.kit.counterparts import ActionCounterpart
    from autograder.kit.evidence import Event, Part
    from autograder.kit.model import Bench

NEAR = 1.0
"""Metres from the door below which the task asks to cancel the walk."""
ROUND_LIMIT = 13.0
"""Seconds of the subject's time that the round may take: a node that drives at half the rate comes to its end, too."""
AFTER = 1.5
"""Seconds of the subject's time that show whether it drives on, and whether it waits for the lamp's answer."""
STEP = 0.5
"""Seconds of the subject's time between two feedback messages, as the robot of the course sends them."""
PATIENCE = 1.5
"""Seconds of wall time in which a goal, or a request to cancel it, must arrive once it is due."""
SLACK = 0.25
"""Seconds by which the last command may seem to come after the call of the lamp, which is sent right behind it."""


lamps, goals = values("request"), values("goal")
"""The subject's requests to the lamp, and the goals of its walks."""


def night(bench: Bench) -> None:
    """Drive the bench through the one part of this exercise."""
    bench.part("night")
    bench.listen(*bench.reference.only("publisher"))
    service, kind = bench.reference.only("client")
    lamp = bench.serve(service, kind, lambda _: {"success": True, "message": "the lamp is on"}, hold=1)
    robot = bench.serve_action(*bench.reference.only("action_client"))
    bench.start()
    for role, ends in bench.reference.interface.items():
        for name in ends:
            bench.await_endpoint(role, name)
    bench.release()
    bench.await_attention()
    bench.run_time(ROUND_LIMIT, until=lambda: any(map(bench.seen().of, ("request", "goal"))))
    bench.run_time(AFTER)
    lamp.release()
    bench.run_time(AFTER, until=lambda: bool(bench.seen().of("goal")))
    if robot.await_goal(PATIENCE):
        walk(bench, robot)
    else:
        bench.note_whether_it_spins()
    bench.stop()


def walk(bench: Bench, robot: ActionCounterpart) -> None:
    """Report the way to the door.

    The number of messages before the one that is near enough is drawn: a subject that counts them, or goes by a clock,
    asks at another one.
    """
    far = sorted((bench.random.uniform(1.2, 2.9) for _ in range(bench.random.randint(4, 9))), reverse=True)
    bench.settle()
    for distance in (*far, 1.05, 0.95, 0.6, 0.3):
        robot.send_feedback(distance=round(distance, 2))
        bench.settle()
        bench.run_time(STEP)
        if distance < NEAR:
            robot.await_cancel(PATIENCE)
    canceled = bool(bench.seen().of("cancel"))
    robot.finish("canceled" if canceled else "succeeded", arrived=not canceled, x=3.0, y=2.0)
    bench.run_time(STEP)


def movement(command: Event) -> str:
    """A command in words: the numbers in it that are not 0."""
    fields = command.data["fields"]
    pairs = [(f"{part}.{axis}", fields[part][axis]) for part in ("linear", "angular") for axis in "xyz"]
    return ", ".join(f"{name} = {value:.6g}" for name, value in pairs if value) or "all numbers 0"


def commands(part: Part) -> list[str]:
    """All commands, in order."""
    return [movement(event) for event in part.of("message")]


def published(messages: Sequence[Event]) -> int:
    """The number of messages that were published, also those that came before the judge was found."""
    return max((len(messages), *(int(event.data.get("number", 0)) for event in messages)))


def in_words(part: Part) -> str:
    """How many commands were published, and what they said."""
    told, many = commands(part), published(part.of("message"))
    return f"{counted(many, 'command')}: {' / '.join(dict.fromkeys(told))}" if told else "no command"


def before_the_lamp(seen: Part) -> int:
    """The number of commands before the lamp was asked for; all of them if it never was."""
    asked, told = seen.first("request"), seen.of("message")
    return published([one for one in told if asked is None or one.moment <= asked.moment + SLACK])


def too_soon(seen: Part, _: Part) -> bool:
    """A mistake: the goal was sent before the lamp had answered."""
    return [event.kind for event in seen.events if event.kind in ("response", "goal")][:1] == ["goal"]


def near_messages(seen: Part) -> int:
    """How many feedback messages below the limit came before the first request to cancel."""
    cancel = seen.first("cancel")
    before = seen.events[: seen.events.index(cancel)] if cancel is not None else seen.events
    return sum(event.kind == "feedback" and event.data["fields"]["distance"] < NEAR for event in before)
