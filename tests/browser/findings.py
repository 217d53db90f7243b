"""What axe-core finds on a page: only what keeps people out, in words that a failing test can show."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from axe_playwright_python.sync_playwright import Axe

if TYPE_CHECKING:
    from playwright.sync_api import Frame, Page

_GRAVE = ("serious", "critical")


def grave_findings(place: Page | Frame, part: str | None = None) -> list[str]:
    """The serious and critical findings: the rule, what it asks for, and where.

    Args:
        place: A page, or what is in one of its frames.
        part: A CSS selector of the part that is looked at; all where it is None.
    """
    # The wheel says "page", and needs no more than its `evaluate`.
    whole: Any = place
    found = Axe().run(whole, context=part).response
    # A part that is not there would have no findings either.
    assert found["passes"], f"axe-core has looked at nothing in {part or 'the page'}"
    return [
        f"{finding['id']} ({finding['impact']}): {finding['help']}: {node['html'][:160]} {node['failureSummary']}"
        for finding in found["violations"]
        if finding["impact"] in _GRAVE
        for node in finding["nodes"]
    ]
