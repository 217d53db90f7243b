"""Decides how well a client waits for its server, and recognizes mistakes in that wait.

Clients of services and clients of actions differ only in some words, which :class:`Wait` contains.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from autograder.kit import giving_up
from autograder.kit.giving_up import GIVE_UP_LIMIT, NOT_AVAILABLE, PATIENCE
from autograder.kit.model import Finding, Mistake, mistake

if TYPE_CHECKING:
    from autograder.kit.evidence import Evidence, Part
    from autograder.kit.model import Advice


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

    @property
    def _with_a_limit(self) -> str:
        return f"`if not your_{self.role}.wait_for_{self.noun}(timeout_sec=5.0):`"

    def for_nobody(self) -> Mistake:
        """Return the mistake "waits forever": there is no server, and the client waits in silence."""
        return mistake(
            "waits_forever",
            lambda evidence: self.fault(evidence).startswith("still waiting"),
            f"If there is no {self.noun}, your client is still waiting after {GIVE_UP_LIMIT:g} s.",
            f"Wait for a few seconds at most: write {self._with_a_limit}. Inside this `if`, report that the "
            f"{self.noun} is not available, and end. If you wait in a loop, count the turns and leave the loop after "
            "a few.",
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
            f"The {self.noun} was available, but it received no {self.asks} from your client, and your client is "
            f"still waiting. A {self.asks} that your client sends before the {self.noun} is available is lost.",
            f"Wait with a time limit: write {self._with_a_limit}. Inside this `if`, report that the {self.noun} is "
            f"not available, and end. wait_for_{self.noun} returns True once the {self.noun} is available, so a loop "
            "that waits begins with `while not`.",
        )

    def the_wrong_way_round(self) -> Mistake:
        """Return the mistake of a missing ``not`` in the client's condition: it gives up only if its server exists."""
        return mistake(
            "not_forgotten",
            self._gives_up_where_served,
            f"Your client says “{{}}” if the {self.noun} is available, and does not say it if the {self.noun} is "
            "missing: the condition of your `if` lacks a `not`, or has one too many.",
            f"wait_for_{self.noun} returns True if the {self.noun} is available. So put {self._with_a_limit} above "
            f"the lines that report a missing {self.noun}.",
            certain=True,
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
            f"Your client gave up, or went on, before it had discovered the {self.noun}, which was available or "
            "started a moment late.",
            f"Wait a few seconds for the {self.noun} before you send the first {self.asks}: "
            f"wait_for_{self.noun}(timeout_sec=5.0). Do not forget the parentheses: without them the method is not "
            "called, and nothing waits.",
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
            "If there is no server, your function {}.",
            f"Use {PATIENCE} once, as the time limit: `if "
            f"not your_client.wait_for_{self.noun}(timeout_sec={PATIENCE}):`. Inside this `if`, report that the "
            f"{self.noun} is not available, and end the function with `raise TimeoutError(...)`. Without `raise` or "
            f"`return` the function goes on and waits again. If you wait in a loop, leave the loop {PATIENCE} "
            "seconds after it began.",
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
