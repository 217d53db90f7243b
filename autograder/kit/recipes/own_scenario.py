"""Subjects for which the exercise writes its own scenario: the recipe has the ladder of common mistakes around it."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from autograder.kit import common_mistakes as common
from autograder.kit.draft import OWN, OWN_LATE, SeenAsItIs
from autograder.kit.evidence import Event
from autograder.kit.hangs import HANGS
from autograder.kit.model import Finding

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from autograder.kit.counterparts import Caller, Speaker
    from autograder.kit.evidence import Evidence, Part
    from autograder.kit.model import Bench, Mistake

_NOUN = {"publisher": "a publisher on", "subscription": "a subscription to", "client": "a client of"}
_NOUN |= {"service": "a service", "action_client": "a client of the action", "action_server": "an action"}
SERVED = 3.0
"""Seconds of wall time in which a service that is on the graph may be called."""


@dataclass(frozen=True)
class Met:
    """A subject that is met and spun, and whom it meets: a listener on each topic on which the reference publishes.

    Attributes:
        bench: Where it happens.
        topics: These topics; in the order of their names, as the others.
        speakers: A publisher of the judge's for each topic that the reference subscribes to.
        callers: A client of the judge's for each of its services.
    """

    bench: Bench
    topics: Sequence[str]
    speakers: Sequence[Speaker]
    callers: Sequence[Caller]

    @property
    def heard(self) -> int:
        """The number of messages that arrived so far, on the one topic or the first."""
        return self.bench.heard(self.topics[0])


def once_met(happens: Callable[[Met], bool]) -> Callable[[Bench], None]:
    """The scenario of one part: a subject is met at all of the reference's endpoints, and then something happens.

    Args:
        happens: Says whether all that it waited for came; where it did not, the judge asks whether the subject is spun.
    """

    def scenario(bench: Bench) -> None:
        roles = {role: dict(sorted(ends.items())) for role, ends in bench.reference.interface.items()}
        publishers, heard, services = (roles.get(r, {}) for r in ("publisher", "subscription", "service"))
        bench.part("met")
        for topic, kind in publishers.items():
            bench.listen(topic, kind)
        speakers = [bench.speak(topic, kind) for topic, kind in heard.items()]
        callers = [bench.call(service, kind) for service, kind in services.items()]
        bench.start()
        if all(bench.await_endpoint(role, name) for role, ends in roles.items() for name in ends):
            bench.release()
            if speakers:
                bench.await_attention()
            called = all(caller.await_server(SERVED) for caller in callers)
            if not (called and happens(Met(bench, tuple(publishers), speakers, callers))):
                bench.note_whether_it_spins()
        bench.stop()

    return scenario


class OwnScenario:
    """The recipe for a subject with endpoints of some roles. Its view is what was seen in the first part.

    Args:
        scenario: Drives the bench, such as one of :func:`once_met`. One of your own takes name and type from
            ``bench.reference.only(role)``; where it has several, their types by their names from
            ``bench.reference.interface[role]``.
        roles: Such as ``"publisher"``, the most telling first.
    """

    def __init__(self, scenario: Callable[[Bench], None], *roles: str) -> None:
        self.roles = roles
        self.scenario = scenario

    def seen(self, evidence: Evidence) -> Part:
        """The subject, as it was seen."""
        return evidence.main

    def expected(self, evidence: Evidence) -> Part:
        """The recording of the reference solution, with its endpoints.

        While that is being recorded it is what was seen itself.
        """
        if not evidence.reference.parts:
            return evidence.main
        recorded, interface = evidence.reference.parts[0], evidence.reference.interface
        return replace(recorded, events=[Event(0.0, "interface", "graph", interface), *recorded.events])

    def has(self, role: str) -> Callable[[Evidence], Finding]:
        """For :meth:`autograder.kit.draft.Draft.asks`: the endpoints of a role have the reference's names and types."""

        def judge(evidence: Evidence) -> Finding:
            wanted, made = evidence.reference.interface.get(role, {}), evidence.main.endpoints(role)
            return Finding(
                bool(wanted) and wanted.items() <= made.items(),
                _in_words(role, wanted),
                _in_words(role, made) or "nothing of this kind",
            )

        return judge

    @property
    def ladder(self) -> tuple[Mistake, ...]:
        """The common mistakes, most telling first."""
        on_topics = [role for role in self.roles if role in ("publisher", "subscription")]
        return (
            *common.CRASHES,
            common.NEVER_CONSTRUCTED,
            *map(common.endpoint_name, self.roles),
            *map(common.message_type, self.roles),
            OWN,
            *map(common.qos_mismatch, on_topics),
            *common.OTHER_CRASHES,
            *HANGS,
            common.AWAITS_IN_VAIN,
            *map(common.never_spun, self.roles),
            *map(common.went_deaf, self.roles),
            OWN_LATE,
            *common.NOTHING_THERE,
        )


def _in_words(role: str, endpoints: Mapping[str, str]) -> str:
    return ", ".join(f"{_NOUN[role]} {name} ({kind})" for name, kind in sorted(endpoints.items()))


class OwnLadder(SeenAsItIs):
    """The recipe for a subject without an endpoint: the exercise says which common mistakes it may show, too.

    Its view is all that was seen.

    Args:
        scenario: Drives the bench.
        ladder: The common mistakes, most telling first, with the places of the exercise's own among them.
    """

    roles = ()

    def __init__(self, scenario: Callable[[Bench], None], *ladder: Mistake) -> None:
        self.scenario = scenario
        self.ladder = ladder
