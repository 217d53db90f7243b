"""One judge for all tests of this folder that change nothing of it: a process of tests takes them all."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from tests.notebook.checked import Checked, Diagnosed, a_judge

if TYPE_CHECKING:
    from collections.abc import Iterator

    from autograder.verdict import Diagnosis


@pytest.fixture(scope="package")
def checked() -> Iterator[Checked]:
    """A check of a function or a class of this process."""
    with a_judge() as check:
        yield check


@pytest.fixture
def diagnosed(checked: Checked) -> Diagnosed:
    """What a check tells of a wrong one."""

    def told(exercise: str, subject: object) -> Diagnosis:
        diagnosis = checked(exercise, subject).diagnosis
        assert diagnosis is not None
        return diagnosis

    return told
