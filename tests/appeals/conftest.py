"""An appeal about a talker, made of what the reference solution does: no ROS node is started for it."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import pytest

from autograder import exercises
from autograder.appeals import appeal_file
from autograder.appeals.appeal_file import Appeal, AppealedCell
from autograder.judge import evidence_files, one_check
from autograder.kit.evidence import Event, Evidence, Part

if TYPE_CHECKING:
    from pathlib import Path

ID = "lab_1_2.talker"


@pytest.fixture
def appeal() -> Appeal:
    """Judged by the present code: passed with full points."""
    stored = evidence_files.load_reference(ID)
    (talking,) = stored.parts
    graph = Event(0.1, "interface", "graph", stored.interface)
    messages = [replace(event, t=0.2 + 0.01 * place) for place, event in enumerate(talking.events)]
    seen = Evidence([Part(talking.name, talking.inputs, [graph, *messages])], stored)
    verdict = replace(one_check.decide(exercises.get(ID), seen, "a seed"), seconds=2.0)
    kept = evidence_files.unpack(
        evidence_files.pack(verdict, seen, evidence_files.reference_digest(ID), at=1.8e9)
    )
    cells = [AppealedCell("TalkerNode", ["class TalkerNode(Node):", "    pass"])]
    return Appeal("ada", "lab_1_2", "lab_1_2", "Talk.", "0123456789abcdef", cells, {"x": 1}, kept)


@pytest.fixture
def file(appeal: Appeal, tmp_path: Path) -> Path:
    """The same, written down."""
    path = tmp_path / "appeal.json"
    path.write_bytes(appeal_file.dump(appeal))
    return path
