"""Subjects for which the exercise writes its own scenario: the recipe has the ladder of common mistakes around it."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from autograder.kit import common_mistakes as common
from autograder.kit.draft import OWN, OWN_LATE, SeenAsItIs
from autograder.kit.evidence import Event
from autograder.kit.hangs import HANGS
from autograder.kit.model import Finding

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from autograder.kit.evidence import Evidence, Part
    from autograder.kit.model import Bench, Mistake

_NOUN = {"publisher": "a publisher on", "subscription": "a subscription to", "client": "a client of"}
_NOUN |= {"service": "a service", "action_client": "a client of the action", "action_server": "an action"}


class OwnScenario:
    """The recipe for a subject with endpoints of some roles. Its view is what was seen in the first part.

    Args:
        scenario: Drives the bench. It takes name and type from ``bench.reference.only(role)``; where it has several,
            their types by their names from ``bench.reference.interface[role]``.
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

    def is_there(self, evidence: Evidence) -> Finding:
        """The endpoints of the first role have the reference's names and types."""
        return self.has(self.roles[0])(evidence)

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
            *map(common.never_spun, self.roles),
            *map(common.went_deaf, self.roles),
            OWN_LATE,
            common.one_is_missing(*self.roles),
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
