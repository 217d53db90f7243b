"""Subjects for which the exercise has its own scenario: the recipe adds the common mistakes."""

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
"""Seconds of wall time within which a service on the graph must become callable."""


@dataclass(frozen=True)
class Met:
    """A subject that is discovered and spun, with the judge's endpoints that it talks to.

    Attributes:
        bench: The bench of the scenario.
        topics: The topics on which the reference publishes; sorted by name, like the others.
        speakers: A publisher of the judge for each topic that the reference subscribes to.
        callers: A client of the judge for each of the reference's services.
    """

    bench: Bench
    topics: Sequence[str]
    speakers: Sequence[Speaker]
    callers: Sequence[Caller]

    @property
    def heard(self) -> int:
        """The number of messages received so far, on the only topic or the first one."""
        return self.bench.heard(self.topics[0])


def once_met(happens: Callable[[Met], bool]) -> Callable[[Bench], None]:
    """Return the scenario of one part: the judge discovers the subject at all endpoints, then ``happens`` runs.

    Args:
        happens: Returns True if everything that it waited for came; otherwise the judge checks whether the subject is
            spun.
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
    """The recipe for a subject with endpoints of some roles. Its view is the record of the first part.

    Args:
        scenario: Drives the bench, such as one of :func:`once_met`. Your own gets name and type from
            ``bench.reference.only(role)``; if a role has several endpoints, their types by name are in
            ``bench.reference.interface[role]``.
        roles: Such as ``"publisher"``, the most telling first.
    """

    def __init__(self, scenario: Callable[[Bench], None], *roles: str) -> None:
        self.roles = roles
        self.scenario = scenario

    def seen(self, evidence: Evidence) -> Part:
        """The judge's evidence of the subject."""
        return evidence.main

    def expected(self, evidence: Evidence) -> Part:
        """The recording of the reference solution, with its endpoints.

        While the reference is being recorded, this is the record itself.
        """
        if not evidence.reference.parts:
            return evidence.main
        recorded, interface = evidence.reference.parts[0], evidence.reference.interface
        return replace(recorded, events=[Event(0.0, "interface", "graph", interface), *recorded.events])

    def has(self, role: str) -> Callable[[Evidence], Finding]:
        """Return a function for :meth:`autograder.kit.draft.Draft.asks`: a role has the reference's names and types."""

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
    """The recipe for a subject without an endpoint: the exercise lists the common mistakes that it may show.

    Its view is all evidence.

    Args:
        scenario: Drives the bench.
        ladder: The common mistakes, most telling first, with placeholders for the exercise's own.
    """

    roles = ()

    def __init__(self, scenario: Callable[[Bench], None], *ladder: Mistake) -> None:
        self.scenario = scenario
        self.ladder = ladder
