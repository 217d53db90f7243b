"""Decides how well a client waits for its server, and recognizes mistakes in that wait.

Clients of services and clients of actions differ only in some words, which :class:`Wait` contains.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from autograder.kit import giving_up
from autograder.kit.giving_up import GIVE_UP_LIMIT, NOT_AVAILABLE, PATIENCE
from autograder.kit.model import Finding, Mistake, card_words, mistake

if TYPE_CHECKING:
    from autograder.kit.evidence import Evidence, Part
    from autograder.kit.model import Advice

_WORDS = card_words(__file__)


@dataclass(frozen=True)
class Wait:
    """The criterion and the mistakes of a client that waits for its server.

    Attributes:
        noun: The word for the server, as in ``wait_for_service``: ``"service"`` or ``"server"``.
        role: The role of the client's endpoint: ``"client"`` or ``"action_client"``.
        asks: The kind of event that is recorded when the client asks its server: ``"request"`` or ``"goal"``.
        absent: The name of the run without a server.
        served: The names of the runs with a server. In the first of these runs the server comes late.
    """

    noun: str
    role: str
    asks: str
    absent: str
    served: tuple[str, ...]

    def runs(self, evidence: Evidence) -> list[Part]:
        """Return the runs with a server."""
        return [evidence.part(name) for name in self.served]

    def asked(self, part: Part) -> bool:
        """Return True if the client sent a request or a goal in a run."""
        return part.first(self.asks) is not None

    def _had_server(self, evidence: Evidence) -> list[Part]:
        """Return the runs in which the client must not report that the server is missing.

        Such a run has a server, and the client sent a request in it. But in the first run the server comes late,
        so the client may rightly report a missing server before it sends its request. So the first run is returned only
        if the client gave up in that run: it sent no request, and looked for no other server.
        """
        late, *others = self.runs(evidence)
        found = [part for part in others if self.asked(part)]
        without = evidence.part(self.absent).events and not (
            self.asked(late) or self._looks_elsewhere(evidence)
        )
        return [*found, late] if without else found

    def _looks_elsewhere(self, evidence: Evidence) -> bool:
        """Return True if the client looked for a server whose name or type differs from the exercise's.

        A wrong type counts only if the client kept waiting in the run without a server. A wrong name always counts.
        """
        name, kind = evidence.reference.only(self.role)
        looked_for = [found for part in evidence for found in part.endpoints(self.role).items()]
        waits_on = evidence.part(self.absent).ending is None
        return any(other != name or (waits_on and its_type != kind) for other, its_type in looked_for)

    def fault(self, evidence: Evidence) -> str:
        """Return in words what is wrong in the run without a server; empty if the client gives up as it should."""
        return giving_up.objection(evidence.part(self.absent), self._had_server(evidence), self.role)

    def gives_up(self, evidence: Evidence, wrong: str = "") -> Finding:
        """Decide whether the client handles a missing server well, in one of two ways.

        Either the client reports that the server is missing and ends by itself, or it keeps waiting and repeatedly
        reports that it waits.

        Args:
            evidence: All runs of the client.
            wrong: A fault in the run without a server that the caller has found, in words; empty if the caller has
                found none.
        """
        waits_on = giving_up.goes_on_waiting(evidence.part(self.absent))
        wrong = wrong or self.fault(evidence)
        seen = wrong or ("reports repeatedly that it waits" if waits_on else "it did")
        return Finding(not wrong, f"says {NOT_AVAILABLE} and ends by itself", seen)

    # --- mistakes ------------------------------------------------------------------------------------------------

    def _words(self, name: str) -> tuple[str, str]:
        """Return the two texts of a mistake for this kind of client."""
        words = {"noun": self.noun, "asks": self.asks, "limit": GIVE_UP_LIMIT, "patience": PATIENCE}
        with_a_limit = f"`if not your_{self.role}.wait_for_{self.noun}(timeout_sec=5.0):`"
        text, next_step = (one.format(**words, with_a_limit=with_a_limit) for one in _WORDS[name])
        return text, next_step

    def for_nobody(self) -> Mistake:
        """Return the mistake "waits forever": there is no server, and the client waits in silence."""
        return mistake(
            "waits_forever",
            lambda evidence: self.fault(evidence).startswith("still waiting"),
            *self._words("for_nobody"),
            certain=True,
            uses=(f"wait_for_{self.noun}",),
        )

    def for_ever(self) -> Mistake:
        """Return the mistake "waits forever": there is a server, but the client waits and sends nothing to it."""
        return mistake(
            "waits_forever",
            lambda evidence: any(
                part.endpoints(self.role) and part.ending is None and not self.asked(part)
                for part in self.runs(evidence)
            ),
            *self._words("for_ever"),
        )

    def the_wrong_way_round(self) -> Mistake:
        """Return the mistake of a missing ``not`` in the client's condition: it gives up only if its server exists."""
        return mistake(
            "not_forgotten", self._gives_up_where_served, *self._words("wrong_way_round"), certain=True
        )

    def _gives_up_where_served(self, evidence: Evidence) -> str:
        """Return the line with which a client gives up although there is a server; otherwise empty.

        It is a line that the client prints in each run with a server, but not in the run without one.
        """
        absent, served = evidence.part(self.absent), self.runs(evidence)
        if not absent.events or NOT_AVAILABLE.lines(absent):
            return ""
        if any(self.asked(part) or not (part.ending and part.endpoints(self.role)) for part in served):
            return ""
        told = [NOT_AVAILABLE.lines(part) for part in served]
        return told[0][-1] if all(told) else ""

    def too_short(self) -> Mistake:
        """Return the mistake "gave up too early": the client gives up before its server exists."""
        return mistake(
            "gave_up_too_early",
            lambda evidence: giving_up.gave_up(self.runs(evidence), evidence.part(self.absent), self.asked),
            *self._words("too_short"),
            uses=(f"wait_for_{self.noun}",),
        )

    def patience_not_kept(self) -> Mistake:
        """Return the mistake of a function that, without a server, waits shorter or longer than it was told."""
        return mistake(
            "patience_not_kept",
            lambda evidence: (
                ""
                if giving_up.looked_for_nobody(evidence)
                else giving_up.broken_patience(evidence.part(self.absent))
            ),
            *self._words("patience_not_kept"),
        )

    def silent_end(self, *, certain: bool = False) -> Mistake:
        """Return the mistake of a client that ends without a report if its server is missing.

        The client is known to send requests or goals, because it did so in the first run with a server.
        """

        def recognize(evidence: Evidence) -> Advice | None:
            if not self.asked(evidence.part(self.served[0])):
                return None
            return giving_up.silent_end(evidence.part(self.absent), self._had_server(evidence), self.noun)

        return Mistake("silent_end", recognize, certain)
