"""A client's wait for its server: the runs with and without a server, what the client says, and its mistakes.

The clients of services and of actions differ only in words: see :class:`Wait`.
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
    """The wait of one kind of client.

    Attributes:
        noun: The word for the server, as in ``wait_for_service``: ``"service"`` or ``"server"``.
        role: The role of the client's endpoint: ``"client"`` or ``"action_client"``.
        asks: The kind of event that is recorded when the client asks its server: ``"request"`` or ``"goal"``.
        absent: The name of the run without a server.
        served: The names of the runs with a server. In the first of them the server comes late.
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
        """Return True if the client asked its server for something in a run."""
        return part.first(self.asks) is not None

    def had_server(self, evidence: Evidence) -> list[Part]:
        """Return the runs in which the client had its server, so a report in them that a server is missing is wrong.

        In the first run the server comes late, so a client may report it missing there. That run is therefore left
        out, unless the client never sends a request in it.
        """
        late, *others = self.runs(evidence)
        found = [part for part in others if self.asked(part)]
        without = evidence.part(self.absent).events and not (
            self.asked(late) or self._looks_elsewhere(evidence)
        )
        return [*found, late] if without else found

    def _looks_elsewhere(self, evidence: Evidence) -> bool:
        """Return True if the client was seen to look for a server other than the one that the exercise asks for.

        A wrong name always counts. A wrong type counts only if the client kept waiting in the run without a server.
        """
        name, kind = evidence.reference.only(self.role)
        looked_for = [found for part in evidence for found in part.endpoints(self.role).items()]
        waits_on = evidence.part(self.absent).ending is None
        return any(other != name or (waits_on and its_type != kind) for other, its_type in looked_for)

    def fault(self, evidence: Evidence) -> str:
        """Return the fault in how the client gives up without a server, in words; empty if there is none."""
        return giving_up.objection(evidence.part(self.absent), self.had_server(evidence), self.role)

    def gives_up(self, evidence: Evidence, wrong: str = "") -> Finding:
        """Decide whether the client does one of two right things if there is no server.

        It may report the missing server and end by itself, or keep waiting and say repeatedly that it waits.

        Args:
            evidence: All runs of the client.
            wrong: Another fault that was seen in the run without a server, in words.
        """
        waits_on = giving_up.goes_on_waiting(evidence.part(self.absent))
        wrong = wrong or self.fault(evidence)
        seen = wrong or ("says again and again that it waits" if waits_on else "it did")
        return Finding(not wrong, f"says {NOT_AVAILABLE} and ends by itself", seen)

    # --- mistakes ------------------------------------------------------------------------------------------------

    @property
    def _with_a_limit(self) -> str:
        return f"`if not your_{self.role}.wait_for_{self.noun}(timeout_sec=5.0):`"

    def for_nobody(self) -> Mistake:
        """Return the mistake of a client that, without a server, waits in silence forever."""
        return mistake(
            "waits_forever",
            lambda evidence: self.fault(evidence).startswith("still waiting"),
            f"When there is no {self.noun}, your client is still waiting after {GIVE_UP_LIMIT:g} s.",
            f"Give the wait a limit of a few seconds: write {self._with_a_limit}, and below it report that the "
            f"{self.noun} is not available, and stop. A loop needs a count.",
            certain=True,
        )

    def for_ever(self) -> Mistake:
        """Return the mistake of a client that, although there is a server, waits forever and asks for nothing."""
        return mistake(
            "waits_forever",
            lambda evidence: any(
                part.endpoints(self.role) and part.ending is None and not self.asked(part)
                for part in self.runs(evidence)
            ),
            f"The {self.noun} was there, but no {self.asks} of your client reached it, and your client waits on. A "
            f"{self.asks} that is sent before the {self.noun} is there is lost.",
            f"Wait with a limit: write {self._with_a_limit}, and below it report that the {self.noun} is not "
            f"available, and stop. wait_for_{self.noun} returns True as soon as the {self.noun} is there, so a loop "
            "that waits begins with `while not`.",
        )

    def the_wrong_way_round(self) -> Mistake:
        """Return the mistake of a client whose condition lacks a ``not``: it gives up only if its server exists."""
        return mistake(
            "not_forgotten",
            self._gives_up_where_served,
            f"Your client says “{{}}” if the {self.noun} is there, and does not say it if there is none: the condition "
            "is the wrong way round.",
            f"wait_for_{self.noun} returns True when the {self.noun} is there. Write {self._with_a_limit} above the "
            f"lines that your client has to run if there is no {self.noun}.",
            certain=True,
        )

    def _gives_up_where_served(self, evidence: Evidence) -> str:
        """Return the line that reports an existing server as missing; empty if a missing one is reported, too."""
        absent, served = evidence.part(self.absent), self.runs(evidence)
        if not absent.events or NOT_AVAILABLE.lines(absent):
            return ""
        if any(self.asked(part) or not (part.ending and part.endpoints(self.role)) for part in served):
            return ""
        told = [NOT_AVAILABLE.lines(part) for part in served]
        return told[0][-1] if all(told) else ""

    def too_short(self) -> Mistake:
        """Return the mistake of a client that gives up before its server exists."""
        return mistake(
            "gave_up_too_early",
            lambda evidence: giving_up.gave_up(self.runs(evidence), evidence.part(self.absent), self.asked),
            f"The {self.noun} was there, or started a moment late, and your client had already given up, or it went on "
            f"before it had discovered the {self.noun}.",
            f"Wait for it, with a few seconds of patience, before the first {self.asks}: "
            f"wait_for_{self.noun}(timeout_sec=5.0). Without the parentheses the method is not called, and "
            "nothing waits.",
        )

    def patience_not_kept(self) -> Mistake:
        """Return the mistake of a function that, without a server, does not wait as long as it was told to."""
        return mistake(
            "patience_not_kept",
            lambda evidence: (
                ""
                if giving_up.looked_for_nobody(evidence)
                else giving_up.broken_patience(evidence.part(self.absent))
            ),
            "When there is no server, your function {}.",
            f"Use {PATIENCE} as the limit, once: `if not your_client.wait_for_{self.noun}(timeout_sec={PATIENCE}):`, "
            "and below it say so and end: `raise TimeoutError(...)`. Without `raise` or `return` it goes on to its "
            f"next wait. A loop has to end {PATIENCE} seconds after it began.",
        )

    def silent_end(self, *, certain: bool = False) -> Mistake:
        """Return the mistake of a client that asks its server for something, but does not report a missing server."""

        def recognise(evidence: Evidence) -> Advice | None:
            if not self.asked(evidence.part(self.served[0])):
                return None
            return giving_up.silent_end(evidence.part(self.absent), self.had_server(evidence), self.noun)

        return Mistake("silent_end", recognise, certain)
