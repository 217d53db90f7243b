"""The notebooks of the course, executed: each master earns full marks, each chapter ends well and earns nothing."""

from __future__ import annotations

from io import StringIO
from typing import TYPE_CHECKING

import pytest
from rich.console import Console

from autograder import course
from autograder.authoring.notebook_execution import REPORTS_FOLDER, execute_all, execution_plan
from autograder.masters.master_files import lab_name, masters
from tests.tiers import asked_for

if TYPE_CHECKING:
    from autograder.authoring.notebook_execution import Executed


@pytest.fixture(scope="module")
def executed(request: pytest.FixtureRequest) -> list[Executed]:
    """The notebooks that this session asks for, as ``./course execute`` runs them."""
    planned = execution_plan(course.root(), asked_for(request, "notebook"))
    return execute_all(planned, course.root() / REPORTS_FOLDER, console=Console(file=StringIO()))


@pytest.mark.ros
@pytest.mark.slow
@pytest.mark.parametrize("notebook", [lab_name(master) for master in masters(course.root())])
def test_master_and_chapter_show_what_they_have_to(notebook: str, executed: list[Executed]) -> None:
    own = [one for one in executed if one.planned.task.notebook == notebook]
    assert len(own) == 2
    assert [(one.planned.label, one.found, one.report) for one in own if one.found] == []
