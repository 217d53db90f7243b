"""The bases of the recipes for nodes: an exercise writes its own scenario, or it only declares the right output.

For an own scenario, the recipe adds the common mistakes. For a declared exercise, the kit also makes the scenario, the
criteria and the mistakes. For example, a ``Relay`` is a node that listens on one topic and publishes on another, and a
``Machine`` is a node with a state that a service changes and a topic reports. The author declares the right output as a
function, and each common wrong answer as a variant of this function.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import reduce
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from autograder.kit.counterparts import Qos
from autograder.kit.draft import Draft, SeenAsItIs
from autograder.kit.evidence import Event, spoken_by, without_tracebacks
from autograder.kit.mistakes.role_mistakes import ladder
from autograder.kit.model import Finding, Pace
from autograder.kit.rules import got_through
from autograder.kit.runners import processes

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence

    from autograder.kit.counterparts import ActionCaller, Caller, Speaker
    from autograder.kit.evidence import Evidence, Part
    from autograder.kit.model import Bench, Exercise, Mistake


_NOUN = {"publisher": "a publisher on", "subscription": "a subscription to", "client": "a client of"}
_NOUN |= {"service": "a service", "action_client": "a client of the action", "action_server": "an action"}
ECHO = 1.0
"""The maximum number of seconds between a logged and a printed line with the same word that count as one report."""
THREADS = 4
"""The number of threads that spin a notebook's class with an action server."""
ENDPOINTS = "endpoints"
"""The name of the event that records the subject's endpoints if one of the reference solution's is missing."""
SERVED = 3.0
"""Time limit in seconds of wall time until the judge can call a service that is on the ROS graph."""


@dataclass(frozen=True)
class Met:
    """A subject that is spun and that the judge has discovered, with the judge's endpoints for it.

    Attributes:
        bench: The bench of the scenario.
        topics: The topics on which the reference solution publishes, sorted by name.
        speakers: A publisher of the judge for each topic to which the reference solution subscribes, sorted by the
            topic's name.
        callers: A client of the judge for each service of the reference solution, sorted by the service's name.
        action_callers: A client of the judge for each action of the reference solution, sorted by the action's name.
    """

    bench: Bench
    topics: Sequence[str]
    speakers: Sequence[Speaker]
    callers: Sequence[Caller]
    action_callers: Sequence[ActionCaller] = ()

    @property
    def heard(self) -> int:
        """The number of messages that the judge has received so far on the first topic, which is often the only one."""
        return self.bench.heard(self.topics[0]) if self.topics else 0


def once_met(happens: Callable[[Met], bool]) -> Callable[[Bench], None]:
    """Return a scenario with one part: the judge waits for all endpoints of the subject, then calls ``happens``.

    Args:
        happens: Returns True if everything for which it waited has arrived. If it returns False, the judge checks
            whether the subject is spun.

    Example::

        def switching(met: Met) -> bool:
            (caller,) = met.callers
            caller.ask({"data": True})
            met.bench.run_time(3.0, until=lambda: met.heard >= 3)
            return caller.await_answers(3.0) and met.heard >= 3

        recipe = OwnScenario(once_met(switching), "publisher", "service")
    """

    def scenario(bench: Bench) -> None:
        meet(bench, "met", happens)

    return scenario


def meet(
    bench: Bench,
    part: str,
    happens: Callable[[Met], bool],
    serves: Callable[[str, str], object] | None = None,
    *,
    listens: bool = True,
    qos: Mapping[str, Qos] = MappingProxyType({}),
    only: str = "",
) -> bool:
    """Run one part of a scenario like :func:`once_met`. Return True if the judge could begin.

    Args:
        happens: As for :func:`once_met`.
        serves: Called with the name and type of each service that the reference solution calls; it makes the server.
        listens: True if the judge subscribes before the subject starts.
        qos: The QoS of the judge's endpoints, by topic.
        only: The role of the subject, if the reference also has the endpoints of other programs; by default all roles.
    """
    interface = bench.reference.interface
    roles = {role: dict(sorted(ends.items())) for role, ends in interface.items() if only in ("", role)}
    publishers, heard, services, actions = (
        roles.get(role, {}) for role in ("publisher", "subscription", "service", "action_server")
    )
    bench.part(part)
    for topic, kind in publishers.items() if listens else ():
        bench.listen(topic, kind, qos=qos.get(topic, Qos.DEFAULT))
    speakers = [bench.speak(topic, kind, qos=qos.get(topic, Qos.DEFAULT)) for topic, kind in heard.items()]
    callers = [bench.call(service, kind) for service, kind in services.items()]
    action_callers = [bench.call_action(action, kind) for action, kind in actions.items()]
    if serves is not None:
        for service, kind in roles.get("client", {}).items():
            serves(service, kind)
    # With a single thread, a notebook's class reads no cancel request while it works on a goal.
    bench.start(**({"threads": THREADS} if actions else {}))
    met = _all_there(bench, [(role, name) for role, ends in roles.items() for name in ends])
    if met:
        bench.release()
        # A subscription loses what is sent before it has discovered the judge's publisher.
        if speakers:
            bench.await_attention()
        met = all(caller.await_server(SERVED) for caller in callers)
        met = met and all(caller.await_server(SERVED) for caller in action_callers)
        if not (met and happens(Met(bench, tuple(publishers), speakers, callers, action_callers))):
            bench.note_whether_it_spins()
            # The callback of a server may hang in a thread of its own while the node still answers.
            if services or actions:
                bench.note_where_it_hangs()
    bench.stop()
    return met


def _all_there(bench: Bench, ends: Sequence[tuple[str, str]]) -> bool:
    """Wait for all endpoints of the reference solution, given as (role, name)."""
    there = not ends or bench.await_endpoint(*ends[0])
    # The programs of a launch start one after the other, so the endpoints of the first are not all.
    if processes(bench.seen()):
        there = bench.watch_graph(
            lambda evidence: all(name in evidence.main.endpoints(role) for role, name in ends),
            QUIET[bench.pace],
        )
    there = there and all(bench.await_endpoint(role, name) for role, name in ends)
    if not there:
        bench.note(ENDPOINTS, made={role: bench.seen().endpoints(role) for role, _ in ends})
    return there


class OwnScenario:
    """The recipe for a subject with endpoints of given roles. A view is the record of the subject's first part.

    Args:
        scenario: The scenario, for example one made by :func:`once_met`. If you write it yourself,
            ``bench.reference.only(role)`` is the name and type of an endpoint; if a role has several endpoints,
            ``bench.reference.interface[role]`` has their types by name.
        roles: The roles of the subject's endpoints, such as ``"publisher"``. The first role is the one whose endpoint
            shows most about the subject.

    Example::

        def listening(met: Met) -> bool:
            met.speakers[0].send(data=19)
            return met.bench.wait_until(lambda evidence: bool(evidence.main.said()), 5.0)

        recipe = OwnScenario(once_met(listening), "subscription")
        guard = Draft("lab_8_1.guard", "Lab 8.1 · The guard", "Warn of a charge below 20 percent.", recipe)
        guard.asks("topic", 2, "Subscribes to the right topic and type", recipe.has("subscription"))
    """

    def __init__(self, scenario: Callable[[Bench], None], *roles: str) -> None:
        self.roles = roles
        self.scenario = scenario

    def view(self, part: Part) -> Part:
        """Return the record of a part as the exercise's criteria see it."""
        return part

    def seen(self, evidence: Evidence) -> Part:
        """Return the record of the subject in its first part."""
        return self.view(evidence.main)

    def expected(self, evidence: Evidence) -> Part:
        """Return the record of the reference solution, including its endpoints.

        While the reference is being recorded, there is no earlier record, so the new one is returned.
        """
        if not evidence.reference.parts:
            return self.view(evidence.main)
        recorded, interface = evidence.reference.parts[0], evidence.reference.interface
        return replace(recorded, events=[Event(0.0, "interface", "graph", interface), *recorded.events])

    def has(self, role: str) -> Callable[[Evidence], Finding]:
        """Return the criterion that the subject's endpoints of a role have the reference's names and types."""

        def judge(evidence: Evidence) -> Finding:
            wanted, made = evidence.reference.interface.get(role, {}), evidence.main.endpoints(role)
            return Finding(
                bool(wanted) and wanted.items() <= made.items(),
                _endpoints(role, wanted),
                _endpoints(role, made) or "nothing of this kind",
            )

        return judge

    @property
    def ladder(self) -> tuple[Mistake, ...]:
        """The common mistakes, most specific first."""
        return ladder(self.roles)


class Spoken(OwnScenario):
    """The recipe for a subject that logs or prints words instead of publishing them.

    For criteria, a line that contains exactly one of the words, in upper or lower case, is a message with this word.

    Args:
        words: The words, as the task names them.
    """

    def __init__(self, scenario: Callable[[Bench], None], words: Sequence[str], *roles: str) -> None:
        super().__init__(scenario, *roles)
        self._words = words

    def view(self, part: Part) -> Part:
        """Return the record, in which each line with exactly one of the task's words is replaced by a message event."""
        lines = [
            (event, word) for _, event in without_tracebacks(part.events) if (word := self._word_in(event))
        ]
        # A logged line is recorded twice: on /rosout and in the terminal. Leave out the terminal's copy.
        if any(event.kind == "log" for event, _ in lines):
            lines = [(event, word) for event, word in lines if not _has_logger_prefix(event)]
        told = {
            id(event): replace(
                event, kind="message", name="log", data={**event.data, "fields": {"data": word}}
            )
            for event, word in _without_echoes(lines)
        }
        heard = [event for event in part.events if event.kind != "message"]
        return replace(part, events=[told.get(id(event), event) for event in heard])

    def _word_in(self, event: Event) -> str:
        """Return the only word in a logged or printed line; empty if the line has none of them or several."""
        line = (spoken_by(event) or "").casefold() if event.kind in ("log", "output") else ""
        found = [word for word in self._words if word.casefold() in line]
        return found[0] if len(found) == 1 else ""


def _has_logger_prefix(event: Event) -> bool:
    """Return True if a line of the terminal has the prefix of a logger."""
    return event.kind == "output" and spoken_by(event) != event.data["text"]


def _without_echoes(lines: Sequence[tuple[Event, str]]) -> Iterator[tuple[Event, str]]:
    """Yield the lines. If the same word is logged and at once printed, or printed and logged, yield one line only."""
    said, kind, at = "", "", 0.0
    for event, word in lines:
        if word != said or event.kind == kind or event.moment - at > ECHO:
            said, kind, at = word, event.kind, event.moment
            yield event, word


def _endpoints(role: str, endpoints: Mapping[str, str]) -> str:
    return ", ".join(f"{_NOUN[role]} {name} ({kind})" for name, kind in sorted(endpoints.items()))


class OwnLadder(SeenAsItIs):
    """The recipe for a subject without endpoints, such as a function that only reads the ROS graph.

    The views are the whole evidence, and the exercise itself lists the common mistakes.

    Args:
        scenario: The function that runs all parts of the exercise on a bench.
        ladder: The common mistakes, most specific first, with placeholders for the exercise's mistakes.
    """

    roles = ()

    def __init__(self, scenario: Callable[[Bench], None], *ladder: Mistake) -> None:
        self.scenario = scenario
        self.ladder = ladder


QUIET = {Pace.FAST: 3.0, Pace.REAL_TIME: 6.0}
"""The judge stops waiting for an answer or a message if no event comes for this many seconds of wall time."""
SILENCE = object()
"""The author's function returns this if the subject must not publish anything."""


class Declared:
    """The base class of exercises in which the author declares the right output.

    Args:
        exercise_id: The lab's folder and the file's name, such as ``"lab_8_1.filter"``.
        title: The title of the card, naming the lab and the subject.
        task: One sentence that states the task.
        scenario: The function that runs all parts of the exercise on a bench.
        roles: The roles of the subject's endpoints. The first role is the one whose endpoint shows most about the
            subject.
        given: The kind of event that records an input that the subject has certainly received. If a subject got fewer
            inputs than the reference solution, it fails the criteria about its outputs.
        words: The words that the subject logs or prints; empty if it publishes its output.
    """

    def __init__(
        self,
        exercise_id: str,
        title: str,
        task: str,
        scenario: Callable[[Bench], None],
        *roles: str,
        given: str,
        words: Sequence[str] = (),
    ) -> None:
        self._subject = Spoken(scenario, words, *roles) if words else OwnScenario(scenario, *roles)
        self._draft = Draft(exercise_id, title, task, self._subject)
        self._text: dict[str, str] = {}
        self._given = given

    def asks(self, name: str, points: float, title: str, role: str, words: str = "") -> None:
        """Add the criterion that the subject's endpoints of a role have the same names and types as the reference's.

        Args:
            name: A stable key for the criterion.
            title: The criterion in one line, as the card shows it.
            role: The role of the endpoints, such as ``"subscription"``.
            words: The sentence of the task that the criterion judges, exactly as in ``lab.md``.
        """
        self._draft.asks(name, points, title, self._subject.has(role))
        self._judges(name, words)

    def exercise(self) -> Exercise:
        """Return the finished exercise. Call this after adding all criteria and mistakes."""
        return self._draft.exercise(text=self._text)

    def _got_through(self, seen: Part, expected: Part) -> bool:
        return got_through(seen, expected, self._given)

    def _judges(self, name: str, words: str) -> None:
        if words:
            self._text[words] = f"{self._text[words]} {name}" if words in self._text else name

    def _knows(
        self, key: str, found: Callable[[Part], object], says: str, next_step: str, *, certain: bool = True
    ) -> None:
        self._draft.knows(key, lambda seen, _: found(seen), says, next_step, certain=certain)


def pick(fields: Any, path: str) -> Any:
    """Return the value of a field, given by its path, such as ``"pose.position.x"``.

    A question mark at the end, as in ``"message?"``, asks only whether there is a value that is not empty, 0 or false.
    """
    if path.endswith("?"):
        value = pick(fields, path[:-1])
        return bool(value.strip() if isinstance(value, str) else value)
    return reduce(lambda part, key: part[key], path.split("."), fields)
