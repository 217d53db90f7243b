"""Subjects for which the exercise writes its own scenario: the recipe has the ladder of common mistakes around it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from autograder.kit import common_mistakes as common
from autograder.kit.draft import OWN, OWN_LATE
from autograder.kit.hangs import HANGS
from autograder.kit.model import Finding

if TYPE_CHECKING:
    from collections.abc import Callable

    from autograder.kit.evidence import Evidence, Part
    from autograder.kit.model import Bench, Mistake

_NOUN = {"publisher": "a publisher on", "subscription": "a subscription to", "client": "a client of"}
_NOUN |= {"service": "a service", "action_client": "a client of the action", "action_server": "an action"}


class OwnScenario:
    """The recipe for a subject with one endpoint of each of its roles. Its view is what was seen in the first part.

    Args:
        scenario: Drives the bench. It takes names and types from ``bench.reference.only(role)``.
        roles: Such as ``"publisher"``, the most telling first.
    """

    def __init__(self, scenario: Callable[[Bench], None], *roles: str) -> None:
        self.roles = roles
        self.scenario = scenario

    def seen(self, evidence: Evidence) -> Part:
        """The subject, as it was seen."""
        return evidence.main

    def expected(self, evidence: Evidence) -> Part:
        """The reference solution, as it was recorded; the subject itself while that is being recorded."""
        return evidence.reference.parts[0] if evidence.reference.parts else evidence.main

    def is_there(self, evidence: Evidence) -> Finding:
        """The endpoint of the first role has the reference's name and type."""
        role = self.roles[0]
        name, type_name = evidence.reference.only(role)
        made = evidence.main.endpoints(role)
        seen = ", ".join(f"{_NOUN[role]} {other} ({kind})" for other, kind in sorted(made.items()))
        expected = f"{_NOUN[role]} {name} ({type_name})"
        return Finding(made.get(name) == type_name, expected, seen or "nothing of this kind")

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
            *common.NOTHING_THERE,
        )


class OwnLadder:
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

    def seen(self, evidence: Evidence) -> Evidence:
        """The subject, as it was seen."""
        return evidence

    def expected(self, evidence: Evidence) -> Evidence:
        """The same: nothing is recorded of a subject without an endpoint."""
        return evidence
