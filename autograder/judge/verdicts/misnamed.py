"""Finds endpoints to which a subject gave a wrong name, so that a wrong name fails only one criterion."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from autograder.kit.evidence import Evidence
    from autograder.verdict import Verdict


def misnamed(evidence: Evidence, verdict: Verdict) -> dict[str, dict[str, str]]:
    """Return the endpoints to which the subject gives a wrong name; the keys are the right names, as in the task.

    An endpoint counts as misnamed if, in all parts, the subject has no endpoint with the right name, role and type, but
    exactly one other endpoint with this role and type. If there are two others, neither is returned, because it is
    unclear which one was meant.

    Args:
        evidence: The evidence of a look in which the judge used the names in the task.
        verdict: The verdict on this evidence, which is not a pass.

    Returns:
        For each name: ``real``, the name that the subject uses, and ``costs``, the name of the first criterion that
        fails because of the wrong name.
    """
    costs = next(criterion.name for criterion in verdict.criteria if not criterion.passed)
    found: dict[str, dict[str, str]] = {}
    for role, asked in evidence.reference.interface.items():
        made = {name: kind for part in evidence for name, kind in part.endpoints(role).items()}
        for kind in set(asked.values()):
            missing = [name for name, type_name in asked.items() if type_name == kind and name not in made]
            others = [name for name, type_name in made.items() if type_name == kind and name not in asked]
            if len(missing) == len(others) == 1:
                found[missing[0]] = {"real": others[0], "costs": costs}
    return found
