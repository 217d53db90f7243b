"""For each exercise: an appeal file of what the judge has seen brings the same verdict."""

from __future__ import annotations

from typing import TYPE_CHECKING

import msgspec
import pytest

from autograder import exercises
from autograder.appeals import appeal_file
from autograder.appeals.replaying import replay
from autograder.authoring.answer_bank import answers
from autograder.judge import evidence_files
from autograder.kit.evidence import Evidence, Reference
from tests.measure import evidence

if TYPE_CHECKING:
    from pathlib import Path

    from autograder.judge.evidence_files import Kept

CHECK = appeal_file.AppealedCheck("ada", "a", "n", "Do it.", "course", [])
NO_REFERENCE = Reference("", {}, [])
ANSWERS = [
    next(
        answer
        for answer in answers([exercise_id])
        if answer.short_name.startswith("wrong") and "syntax_error" not in answer.diagnoses
    )
    for exercise_id in exercises.all_ids()
    if exercises.get(exercise_id).enough  # the bank has no answers to the question of a ticket
]


@pytest.fixture(scope="module", params=ANSWERS, ids=lambda answer: answer.name)
def seen(request: pytest.FixtureRequest) -> Kept:
    """What the judge saw of a wrong answer to each exercise, with what it says of that today."""
    answer = request.param
    seen = evidence.record_of(answer, evidence.kept(answer.exercise).get(answer.name)).seen
    return msgspec.structs.replace(seen, verdict=replay(seen).now)


def test_an_appeal_file_brings_the_same_verdict_again(seen: Kept, tmp_path: Path) -> None:
    looks: Evidence | None = None
    for look in seen.looks:
        looks = Evidence(look.parts, NO_REFERENCE, look.real_time, looks)
    assert looks is not None
    file = tmp_path / "appeal.zip"
    digest = evidence_files.reference_digest(seen.verdict.exercise)
    packed = evidence_files.pack(seen.verdict, looks, digest, at=seen.at)
    file.write_bytes(appeal_file.dump(CHECK, packed, {}))
    again = replay(appeal_file.read(file).seen)
    assert (again.differences, again.notes) == ([], [])
    # The whole verdict, the words and the timeline included.
    assert again.now == seen.verdict
