"""A recipe for a node that uses tools: what it asks of services and actions is compared with the solution, too."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import chain, count, repeat
from math import isinf
from typing import TYPE_CHECKING, Any

from autograder.kit.bench import STEP, Pace
from autograder.kit.counterparts import SOON, Work
from autograder.kit.oracle.outputs import NO_OUTPUT, Kind, Output
from autograder.kit.oracle.same_as_solution import NOTHING, SameAsSolution
from autograder.kit.oracle.steps import Goal, Sets, Text, To, pick

if TYPE_CHECKING:
    from random import Random

    from autograder.kit.bench import Bench
    from autograder.kit.evidence import Event
    from autograder.kit.oracle.steps import Step

__all__ = ["Goal", "Sets", "Text", "To", "ToolUser", "Work"]

Read = Callable[[Any], Any]
"""A function of the fields of a message, which returns what is compared of it."""
Paths = str | tuple[str, ...] | Mapping[str, str | Read]
"""What is compared of an output: the path of a field or several, or by a name of its own a path or a function."""
Answers = Sequence[Any] | Callable[[Mapping[str, Any]], Any]
"""The judge's answers in turn, or a function of the fields of a request or goal."""
TOLD, ASKED, DONE, CANCELED = ("message", "answered"), ("request",), ("goal",), ("cancel",)
"""The kinds of events that show what a subject tells, asks of a service, sends to an action, and cancels there."""
_DOES: Mapping[tuple[str, ...], str] = {
    ASKED: "Calls",
    DONE: "Sends goals to",
    CANCELED: "Cancels goals of",
}
_DOES_NOT: Mapping[tuple[str, ...], str] = {
    ASKED: "does not call",
    DONE: "sends no goal to",
    CANCELED: "cancels no goal of",
}
CANCEL = "/cancel"
"""The ending of the name of the output that shows canceled goals, behind the name of the action."""


@dataclass(frozen=True)
class Sent(Output):
    """An output that the subject tells, asks of a service, sends to an action, or cancels there.

    Attributes:
        kinds: The kinds of events that show it.
        reads: What is compared, by its name; a name that is not there is a path itself.
    """

    kinds: tuple[str, ...] = TOLD
    reads: Mapping[str, str | Read] = field(default_factory=dict, hash=False)

    @property
    def title(self) -> str:
        """The line of the criterion on the card."""
        if self.kinds == TOLD:
            return super().title
        return f"{_DOES[self.kinds]} {self.name.removesuffix(CANCEL)} when it has to, and only then"

    def deed(self, came: str) -> str:
        """Return in words what the subject told, asked, sent or canceled."""
        if self.kinds == TOLD:
            return super().deed(came)
        name = self.name.removesuffix(CANCEL)
        if came == NO_OUTPUT:
            return f"{_DOES_NOT[self.kinds]} {name}"
        return f"{_DOES[self.kinds].lower()} {name}: {came}"

    def values(self, events: Sequence[Event]) -> list[list[Any]]:
        """Return what is compared, for each message, request, goal, or cancel request in time among the events."""
        name = self.name.removesuffix(CANCEL)
        sent = [e.data for e in events if e.kind in self.kinds and e.name == name]
        told = [data.get("fields", data) for data in sent if data.get("accepted", True)]
        return [[self._read(fields, path) for path in self.paths] for fields in told]

    def _read(self, fields: Any, name: str) -> Any:
        read = self.reads.get(name, name)
        return pick(fields, read) if isinstance(read, str) else read(fields)


class ToolUser(SameAsSolution):
    """An exercise about a node that uses tools, and does with them what the reference solution does.

    It is a :class:`SameAsSolution`, and has its words. What the node sends is an output like others: all of it is
    compared in each step, so a node that calls a tool when the solution calls none fails.

    Args:
        exercise_id: The lab's folder and the file's name, such as ``"lab_2_5.agent"``.
        title: The title of the card, naming the lab and the subject.
        task: One sentence that states the task.
        gives: Draws the steps. :class:`Text` is an input as JSON.
        tells: As for :class:`SameAsSolution`. A dictionary names what is compared, by a path or by a function of the
            fields: ``{"/said": {"the first word": lambda fields: fields["data"].partition(":")[0]}}``.
        asks: The services that the subject calls, with the paths of the request's fields.
        does: The actions to which the subject sends goals, with the paths of the goal's fields.
        cancels: Those of these actions of which is compared, too, which goals the subject cancels while they run. They
            are counted from 1. The criterion of ``"/walk_to"`` is ``walk_to/cancel``.
        serves: Draws the judge's answers for each service and action: a list of responses, or of :class:`Work`. The
            first call gets the first one; after the last, it comes again and again. In place of the list, a function of
            the request's or goal's fields.
        more: The other arguments of :class:`SameAsSolution`.

    Example::

        EXERCISE = ToolUser(
            "lab_8_1.hands",
            "Tools · The hands",
            "Do what is asked for.",
            gives=lambda random: shuffled(random, [Text("/wanted", {"lamp": True}), Text("/wanted", "lamp")]),
            tells={"/said": "data"},
            asks={"/lamp": "data"},
            does={"/walk_to": ("x", "y")},
            serves={"/lamp": lambda _: [{"success": True}], "/walk_to": lambda _: [Work(), Work(status="aborted")]},
        ).exercise()
    """

    def __init__(
        self,
        exercise_id: str,
        title: str,
        task: str,
        *,
        gives: Callable[[Random], Sequence[Step]],
        tells: Mapping[str, Paths] = NOTHING,
        asks: Mapping[str, Paths] = NOTHING,
        does: Mapping[str, Paths] = NOTHING,
        cancels: Sequence[str] = (),
        serves: Mapping[str, Callable[[Random], Answers]] = NOTHING,
        **more: Any,
    ) -> None:
        self._actions, self._answers = tuple(does), serves
        canceled = {f"{name}{CANCEL}": {"goal": "number"} for name in cancels}
        self._sends = {
            name: (kinds, paths if isinstance(paths, Mapping) else {})
            for kinds, outputs in ((TOLD, tells), (ASKED, asks), (DONE, does), (CANCELED, canceled))
            for name, paths in outputs.items()
        }
        every = more.pop("every", ())
        told = {**tells, **asks, **does, **canceled}
        super().__init__(
            exercise_id,
            title,
            task,
            gives=gives,
            tells={
                name: tuple(paths) if isinstance(paths, Mapping) else paths for name, paths in told.items()
            },
            serves=serves,  # type: ignore[arg-type]  # here each draws a list
            every=True if every is True else (*every, *asks, *does, *canceled),
            **more,
        )

    def _output(self, name: str, paths: tuple[str, ...], kind: Kind) -> Output:
        if kind is not Kind.STEPS:
            return super()._output(name, paths, kind)
        kinds, reads = self._sends[name]
        return Sent(name, paths, kind, self._tolerance, kinds=kinds, reads=reads)

    def _gives_to(self, bench: Bench, part: str, steps: Sequence[Step], drawn: Random) -> None:
        works = {name: _answering(self._answers[name](drawn)) for name in self._actions}
        super()._gives_to(_ServesActions(bench, works), part, steps, drawn)

    def _serve(self, bench: Bench, steps: Sequence[Step], drawn: Random, service: str, kind: str) -> None:
        del steps
        chosen = _answering(self._answers[service](drawn))
        late: dict[int, float] = {}
        never: set[int] = set()
        numbers = count(1)

        def answer(request: Mapping[str, Any]) -> Mapping[str, Any]:
            # The server looks up when to send an answer after it has asked for it.
            one, number = chosen(request), next(numbers)
            if not isinstance(one, Work):
                return one
            if isinf(one.takes):
                never.add(number)
            else:
                late[number] = one.takes
            return one.result

        bench.serve(service, kind, answer, late=late, never=never)


class _ServesActions:
    """A bench on which actions are served from the beginning of a part, and answers are sent when they are due."""

    def __init__(self, bench: Bench, works: Mapping[str, Callable[[Mapping[str, Any]], Work]]) -> None:
        self._bench, self._works = bench, works

    def __getattr__(self, name: str) -> Any:
        return getattr(self._bench, name)

    def part(self, name: str, **inputs: Any) -> None:
        """Begin a part, and serve the actions."""
        self._bench.part(name, **inputs)
        for action, work in self._works.items():
            kind = self._bench.reference.interface["action_client"][action]
            self._bench.serve_goals(action, kind, work)

    def run_time(self, seconds: float, **how: Any) -> bool:
        """Let time pass. In real time a bench looks once, and then after events, whether an answer is due."""
        if how or self._bench.pace is Pace.FAST:
            return self._bench.run_time(seconds, **how)
        end = self._bench.moment + seconds
        while (left := end - self._bench.moment) > SOON and not self._bench.await_end(0.0):
            self._bench.run_time(min(left, STEP))
        return True


def _answering(answers: Answers) -> Callable[[Mapping[str, Any]], Any]:
    """Return the function that answers: one answer after the other, and then the last one again and again."""
    if callable(answers):
        return answers
    coming = chain(answers, repeat(answers[-1]))
    return lambda _: next(coming)
