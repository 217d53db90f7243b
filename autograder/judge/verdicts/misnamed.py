"""Find the endpoints that a subject has under a wrong name, so that a wrong name costs one criterion and no other."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from autograder.kit.evidence import Evidence
    from autograder.verdict import Verdict


def misnamed(evidence: Evidence, verdict: Verdict) -> dict[str, dict[str, str]]:
    """Return the wrongly named endpoints by the names in the task.

    A name counts as wrong if the subject has no endpoint of this name, role and type in any run, but exactly one other
    endpoint of this role and type. Of two candidates none is chosen: either could be the one that was meant.

    Args:
        evidence: A look in which the judge used the names in the task.
        verdict: The verdict from it, which is not a pass.

    Returns:
        For each name ``real``, the subject's name, and ``costs``, the criterion that the wrong name costs: the first
        that failed.
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
