from __future__ import annotations

import io

import pytest
from rich.console import Console

from autograder.grading.running.batch_progress import BatchProgress


def lines_of(total: int, failed: set[int] = frozenset()) -> list[str]:  # type: ignore[assignment]
    log = io.StringIO()
    with BatchProgress(Console(file=log, width=200), total) as progress:
        for number in range(1, total + 1):
            progress.started(f"student{number}")
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
        progress.started("ada")
        progress.finished("ada", failed=True)
        progress.started("ben")
        progress.finished("ben", failed=False)
    shown = screen.getvalue()
    assert "2/2" in shown
    assert "1 not checked" in shown


def test_a_line_says_what_runs_what_waits_how_fast_and_how_long() -> None:
    line = lines_of(50, {1})[1]
    for word in ("0 running", "waiting", "1 not checked", "/s", "about", "left"):
        assert word in line


def test_a_notebook_gets_plain_lines_too(monkeypatch: pytest.MonkeyPatch) -> None:
    console = Console(file=io.StringIO(), force_terminal=True, width=200)
    console.is_jupyter = True
    printed: list[str] = []
    monkeypatch.setattr(console, "print", lambda text, **_: printed.append(text))
    with BatchProgress(console, 1) as progress:
        assert not progress._bar.live.is_started
        progress.started("ada")
        progress.finished("ada", failed=False)
    assert printed == ["graded 1 of 1: ada"]


class Clock:
    """Time that passes when a test says so."""

    now = 0.0

    def __call__(self) -> float:
        return self.now


def test_the_bar_counts_down_and_then_names_who_takes_so_long() -> None:
    clock, screen = Clock(), io.StringIO()
    console = Console(file=screen, force_terminal=True, width=160)
    with BatchProgress(console, 2, clock=clock) as progress:
        progress.started("ada")
        progress.started("eve")
        clock.now = 5
        progress.finished("ada", failed=False)
        for clock.now, words in ((7, "about 3 s left"), (60, "eve for 1 min 00 s now")):
            progress._bar.refresh()
            assert words in screen.getvalue()
