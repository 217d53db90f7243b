"""The base of the recipes for nodes: an exercise writes its own scenario, and the recipe adds the common mistakes."""

from __future__ import annotations

from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import TYPE_CHECKING

from autograder.kit.bench import Pace
from autograder.kit.counterparts import Qos
from autograder.kit.evidence import Event
from autograder.kit.mistakes.role_mistakes import ladder
from autograder.kit.model import Finding
from autograder.kit.output.launched_processes import processes

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from autograder.kit.bench import Bench
    from autograder.kit.counterparts import ActionCaller, Caller, Speaker
    from autograder.kit.evidence import Evidence, Part
    from autograder.kit.model import Mistake


_NOUN = {"publisher": "a publisher on", "subscription": "a subscription to", "client": "a client of"}
_NOUN |= {"service": "a service", "action_client": "a client of the action", "action_server": "an action"}
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
        # A subscription loses what is sent before it has discovered the judge's publisher. A fast look at a subject
        # that hangs ends here.
        if speakers or bench.pace is Pace.FAST:
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

    By its roles, the recipe recognizes the mistakes ``topic_name``, ``service_name``, ``action_name``,
    ``message_type``, ``qos_mismatch``, ``never_published``, ``two_servers``, ``result_missing``,
    ``cancel_not_accepted``, ``called_too_early``, ``await_in_same_group``.

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
        guard.asks("topic", "Subscribes to the right topic and type", recipe.has("subscription"), points=2)
    """

    def __init__(self, scenario: Callable[[Bench], None], *roles: str) -> None:
        self.roles = roles
        self.scenario = scenario

    def seen(self, evidence: Evidence) -> Part:
        """Return the record of the subject in its first part."""
        return evidence.main

    def expected(self, evidence: Evidence) -> Part:
        """Return the record of the reference solution, including its endpoints.

        While the reference is being recorded, there is no earlier record, so the new one is returned.
        """
        if not evidence.reference.parts:
            return evidence.main
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


def _endpoints(role: str, endpoints: Mapping[str, str]) -> str:
    return ", ".join(f"{_NOUN[role]} {name} ({kind})" for name, kind in sorted(endpoints.items()))


QUIET = {Pace.FAST: 3.0, Pace.REAL_TIME: 6.0}
"""The judge stops waiting for an answer or a message if no event comes for this many seconds of wall time."""
