"""An appeal about a talker, made of what the reference solution does: no ROS node is started for it."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING
from zipfile import ZipFile

import pytest

from autograder import exercises
from autograder.appeals import appeal_file
from autograder.appeals.appeal_file import AppealedCell, AppealedCheck
from autograder.judge import evidence_files
from autograder.judge.verdicts import deciding
from autograder.kit.evidence import Event, Evidence, Part

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

ID = "lab_1_2.talker"


CHECK = AppealedCheck(
    "ada",
    "lab_1_2",
    "lab_1_2",
    "Talk.",
    "0123456789abcdef",
    [AppealedCell("TalkerNode", ["class TalkerNode(Node):", "    pass"])],
)


@pytest.fixture(scope="session")
def evidence() -> bytes:
    """Judged by the present code: passed with full points."""
    stored = evidence_files.load_reference(ID)
    (talking,) = stored.parts
    graph = Event(0.1, "interface", "graph", stored.interface)
    messages = [replace(event, t=0.2 + 0.01 * place) for place, event in enumerate(talking.events)]
    seen = Evidence([Part(talking.name, talking.inputs, [graph, *messages])], stored)
    verdict = replace(deciding.decide(exercises.get(ID), seen, "a seed"), seconds=2.0)
    return evidence_files.pack(verdict, seen, evidence_files.reference_digest(ID), at=1.8e9)


@pytest.fixture
def file(evidence: bytes, tmp_path: Path) -> Path:
    """An appeal file with this evidence."""
    path = tmp_path / "appeal.zip"
    path.write_bytes(appeal_file.dump(CHECK, evidence, {"page.html": b"<p>a page"}))
    return path


@pytest.fixture
def edit(file: Path) -> Callable[[str, Callable[[bytes], bytes]], None]:
    """Replace one of the files in the zip by what a function makes of it."""

    def replace_one(name: str, change: Callable[[bytes], bytes]) -> None:
        with ZipFile(file) as whole:
            files = {one: whole.read(one) for one in whole.namelist()}
        with ZipFile(file, "w") as whole:
            for one, data in files.items():
                whole.writestr(one, change(data) if one == name else data)

    return replace_one
