"""Fork servers for all tests of boxes, and of what runs in them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from autograder.boxes.fork_server import ForkServers
from autograder.boxes.sandbox import why_impossible

if TYPE_CHECKING:
    from collections.abc import Iterator

    from autograder.boxes.fork_server import Addresses

NO_JUDGE = "autograder.boxes.box_supervisor"
"""These tests need none: any module with a \"prepare\" will do."""


class SilentJudge:
    """Sees nothing, so that no check has a verdict."""

    def open(self, exercise_id: str) -> None: ...

    def close(self) -> None: ...


@pytest.fixture(scope="session")
def boxed() -> Iterator[Addresses]:
    """The fork servers of a machine with a sandbox."""
    why = why_impossible()
    if why:
        pytest.skip(f"no sandbox is possible here: {why}")
    with ForkServers(NO_JUDGE, boxed=True) as warm:
        yield warm.with_programs()


@pytest.fixture(scope="session")
def unboxed() -> Iterator[Addresses]:
    """The fork servers where nothing is boxed."""
    with ForkServers(NO_JUDGE, boxed=False) as warm:
        yield warm.addresses
