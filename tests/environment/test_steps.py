"""The steps of the set-up: what is done again, and when."""

from __future__ import annotations

import threading
from typing import TYPE_CHECKING

import pytest

from environment import steps as environment_steps
from environment.steps import Step, digest, run_steps

if TYPE_CHECKING:
    from pathlib import Path


class Recorder:
    """Steps that write down that they ran, one of which can fail."""

    def __init__(self, root: Path):
        self.root = root
        self.ran: list[str] = []
        self.failing = ""

    def step(self, name: str, *inputs: str | Path, stands_alone: bool = False) -> Step:
        def run() -> None:
            self.ran.append(name)
            if name == self.failing:
                raise RuntimeError(name)

        return Step(name, f"doing {name}", inputs, run, stands_alone)

    def run(self, *steps: Step) -> list[str]:
        """Run the steps and return the names of those that ran."""
        self.ran = []
        assert run_steps(steps, self.root / "stamps", self.root, lambda line: None) == self.ran
        return self.ran


@pytest.fixture
def recorder(tmp_path: Path) -> Recorder:
    return Recorder(tmp_path)


def test_a_second_run_does_nothing(recorder: Recorder) -> None:
    steps = [recorder.step("one", "a"), recorder.step("two", "b")]
    assert recorder.run(*steps) == ["one", "two"]
    assert recorder.run(*steps) == []


def test_a_changed_input_does_its_step_and_the_later_ones_again(recorder: Recorder) -> None:
    recorder.run(recorder.step("one", "a"), recorder.step("two", "b"), recorder.step("three", "c"))
    again = recorder.run(recorder.step("one", "a"), recorder.step("two", "B"), recorder.step("three", "c"))
    assert again == ["two", "three"]


def test_a_step_that_stands_alone_repeats_no_other_and_is_repeated_after_an_earlier_one(
    recorder: Recorder,
) -> None:
    def steps(first: str, package: str) -> list[Step]:
        return [
            recorder.step("first", first),
            recorder.step("package", package, stands_alone=True),
            recorder.step("other", "", stands_alone=True),
            recorder.step("last", ""),
        ]

    recorder.run(*steps("a", "a"))
    assert recorder.run(*steps("a", "b")) == ["package"]
    assert recorder.run(*steps("a", "b")[:1], *steps("a", "b")[2:]) == []
    assert recorder.run(*steps("b", "b")) == ["first", "package", "other", "last"]


def test_an_interrupted_run_goes_on_where_it_stopped(recorder: Recorder) -> None:
    steps = [recorder.step("one", "a"), recorder.step("two", "b"), recorder.step("three", "c")]
    recorder.failing = "two"
    with pytest.raises(RuntimeError):
        recorder.run(*steps)
    assert recorder.ran == ["one", "two"]
    recorder.failing = ""
    assert recorder.run(*steps) == ["two", "three"]


def test_a_step_that_failed_is_not_up_to_date_with_its_old_inputs_either(recorder: Recorder) -> None:
    recorder.run(recorder.step("one", "old"))
    recorder.failing = "one"
    with pytest.raises(RuntimeError):
        recorder.run(recorder.step("one", "new"))
    recorder.failing = ""
    assert recorder.run(recorder.step("one", "old")) == ["one"]


def test_a_file_counts_by_its_content_and_not_by_its_time(recorder: Recorder, tmp_path: Path) -> None:
    source = tmp_path / "package.xml"
    source.write_text("<a/>")
    recorder.run(recorder.step("one", source))
    source.touch()
    assert recorder.run(recorder.step("one", source)) == []
    source.write_text("<b/>")
    assert recorder.run(recorder.step("one", source)) == ["one"]


def test_a_stamp_that_cannot_be_read_counts_as_none(recorder: Recorder, tmp_path: Path) -> None:
    recorder.run(recorder.step("one", "a"))
    (tmp_path / "stamps" / "one").write_bytes(b"\xff\xfe")
    assert recorder.run(recorder.step("one", "a")) == ["one"]


def test_a_renamed_file_gives_another_digest(tmp_path: Path) -> None:
    first, second = tmp_path / "a.srv", tmp_path / "b.srv"
    first.write_text("same")
    second.write_text("same")
    assert digest([first], tmp_path) != digest([second], tmp_path)


def test_a_step_that_takes_long_says_that_it_is_still_at_work(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(environment_steps, "SIGN_OF_LIFE", 0.01)
    said: list[str] = []
    twice = threading.Event()

    def say(line: str) -> None:
        said.append(line)
        if sum("still at work" in told for told in said) == 2:
            twice.set()

    def long_work() -> None:
        assert twice.wait(60.0)

    run_steps([Step("long", "working", (), long_work)], tmp_path / "stamps", tmp_path, say)
    assert said[0] == "working"
    assert all(line.startswith("  still at work, after ") for line in said[1:-1])
    assert len(said) >= 4


def test_a_step_that_fails_is_silent_after_that(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(environment_steps, "SIGN_OF_LIFE", 0.01)

    def fail() -> None:
        raise OSError("no room")

    before = threading.active_count()
    with pytest.raises(OSError, match="no room"):
        run_steps([Step("short", "working", (), fail)], tmp_path / "stamps", tmp_path, lambda line: None)
    assert threading.active_count() == before
