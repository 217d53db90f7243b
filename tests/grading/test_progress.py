from __future__ import annotations

import io

import pytest
from rich.console import Console

from autograder.grading.progress import BatchProgress


def lines_of(total: int, failed: set[int] = frozenset()) -> list[str]:  # type: ignore[assignment]
    log = io.StringIO()
    with BatchProgress(Console(file=log, width=200), total) as progress:
        for number in range(1, total + 1):
            progress.started()
            progress.finished(f"student{number}", failed=number in failed)
    assert "\x1b" not in log.getvalue()
    return log.getvalue().splitlines()


@pytest.mark.parametrize("total", [1, 3, 50, 1000])
def test_a_log_file_gets_a_few_plain_lines_and_the_last_says_all(total: int) -> None:
    lines = lines_of(total)
    assert len(lines) <= 30
    assert lines[-1] == f"graded {total} of {total}: student{total}"


def test_what_the_grader_had_trouble_with_has_a_line_of_its_own() -> None:
    assert any("student17" in line for line in lines_of(1000, {17}))


def test_nothing_to_do_says_nothing() -> None:
    assert lines_of(0) == []


def test_a_terminal_gets_a_bar() -> None:
    screen = io.StringIO()
    with BatchProgress(Console(file=screen, force_terminal=True, width=100), 2) as progress:
        progress.started()
        progress.finished("ada", failed=True)
        progress.started()
        progress.finished("ben", failed=False)
    shown = screen.getvalue()
    assert "2/2" in shown
    assert "1 not checked" in shown
