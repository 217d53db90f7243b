"""A mutant is set aside only if a rule shows that it does what the solution does."""

from __future__ import annotations

import pytest

from autograder.authoring.mutants import equivalents
from autograder.authoring.mutants.code import Code
from autograder.authoring.mutants.equivalents import equivalent
from autograder.authoring.mutants.solutions import Solution
from autograder.authoring.mutants.survey import own_mutants
from tests.cases import cases

AGENT = cases(__file__, "AGENT")
SOLUTION = Solution("a.agent", AGENT, "Agent", ((0, len(AGENT)),))


def reasons(operator: str, before: str, kind: str = "") -> set[str]:
    """Return why the mutants that an operator makes of a piece are set aside."""
    code = Code(AGENT, subject="Agent")
    return {
        equivalent(code, one, "Agent")
        for one in own_mutants(SOLUTION)
        if (one.operator, one.before) == (operator, before) and kind in ("", one.kind)
    }


@pytest.mark.parametrize(
    ("operator", "before", "kind", "reason"),
    [
        ("exchanged", "1.0, self.turn", "", equivalents.EXCHANGED),
        ("comparison", "<", "", equivalents.EDGE),
        ("on_the_class", "", "", equivalents.ONE_OBJECT),
        ("kept", "self.came_at = self.get_clock().now()", "largest", equivalents.FORWARD),
        ("remembered", "self.came_at is None", "once false", equivalents.FIRST_NONE),
        ("doubled", 'self.create_subscription(Scan, "a", self.on_scan, 10)', "", equivalents.ONCE_MORE),
    ],
)
def test_what_does_the_same_is_set_aside(operator: str, before: str, kind: str, reason: str) -> None:
    assert reasons(operator, before, kind) == {reason}


@pytest.mark.parametrize(("operator", "before", "kind"), cases(__file__, "what_may_differ_is_not"))
def test_what_may_differ_is_not(operator: str, before: str, kind: str) -> None:
    assert "" in reasons(operator, before, kind)


def test_state_that_is_set_before_it_is_read_may_begin_again() -> None:
    code = Code(AGENT, subject="Agent")
    anew = {
        (one.where, one.after.split()[0]): equivalent(code, one, "Agent")
        for one in own_mutants(SOLUTION)
        if one.operator == "begun_again" and one.kind == "at each call" and one.all_of == 1
    }
    assert anew["Agent.on_scan", "self.seen"] == equivalents.SET_BEFORE
    assert anew["Agent.decide", "self.turn"] == ""
