"""What a subject writes is told to the judge through whichever object it writes, and nothing of it reaches the cell."""

from __future__ import annotations

import ast
import io
import logging
import sys
import threading
from contextlib import suppress
from functools import partial
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

import pytest
from rclpy.logging import get_logger
from rclpy.node import Node
from std_msgs.msg import String

from autograder import own_lines
from autograder.notebook.checking import subject_reports
from autograder.notebook.checking.subject_reports import MOST_CALLS, CapturedOutput
from tests.cases import cases

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from tests.notebook.checked import Checked


class Unchangeable:
    """A stream of a student's own, of which nothing can be replaced."""

    __slots__ = ("text",)

    def __init__(self) -> None:
        self.text = ""

    def write(self, text: str) -> int:
        self.text += text
        return len(text)

    def getvalue(self) -> str:
        return self.text


def printer(stream: Any) -> Callable[[str], object]:
    return partial(print, file=stream)


def logger(stream: Any) -> Callable[[str], object]:
    log = logging.Logger("listener")
    log.addHandler(logging.StreamHandler(stream))
    return log.warning


def writer(stream: Any) -> Callable[[str], object]:
    return lambda text: stream.write(f"{text}\n")


def in_a_thread(do: Callable[[], object]) -> None:
    thread = threading.Thread(target=do)
    thread.start()
    thread.join()


@pytest.fixture
def told() -> list[str]:
    return []


@pytest.mark.parametrize("name", ["stdout", "stderr"])
@pytest.mark.parametrize("holding", [printer, logger, writer])
def test_a_stream_that_was_taken_hold_of_before_is_heard(
    monkeypatch: pytest.MonkeyPatch,
    told: list[str],
    holding: Callable[[Any], Callable[[str], object]],
    name: str,
) -> None:
    stream = io.StringIO()
    monkeypatch.setattr(sys, name, stream)
    say = holding(stream)
    with CapturedOutput(lambda line, _: told.append(line)):
        in_a_thread(lambda: say("I heard: hello"))
    assert told == ["I heard: hello"]
    assert stream.getvalue() == ""
    say("afterwards")
    in_a_thread(lambda: say("and in a thread"))
    assert stream.getvalue() == "afterwards\nand in a thread\n"
    assert "write" not in vars(stream)


def test_both_ways_to_a_stream_are_one(monkeypatch: pytest.MonkeyPatch, told: list[str]) -> None:
    held = io.StringIO()
    monkeypatch.setattr(sys, "stdout", held)

    def say() -> None:
        print("I heard: ", end="")
        held.write("hello\nand no")
        print(" end", end="")

    with CapturedOutput(lambda line, _: told.append(line)):
        in_a_thread(say)
    assert told == ["I heard: hello", "and no end"]
    assert held.getvalue() == ""


def test_who_was_there_before_writes_into_its_cell(monkeypatch: pytest.MonkeyPatch, told: list[str]) -> None:
    stream = io.StringIO()
    monkeypatch.setattr(sys, "stdout", stream)
    say = printer(stream)
    with CapturedOutput(lambda line, _: told.append(line)):
        say("a demonstration")
        print("another one", file=sys.stdout)
    assert stream.getvalue() == "a demonstration\nanother one\n"
    assert told == []


def test_one_stream_for_both_is_put_back(monkeypatch: pytest.MonkeyPatch, told: list[str]) -> None:
    both = io.StringIO()
    own_write = both.write
    both.write = own_write  # type: ignore[method-assign]
    monkeypatch.setattr(sys, "stdout", both)
    monkeypatch.setattr(sys, "stderr", both)
    with CapturedOutput(lambda line, _: told.append(line)):
        in_a_thread(lambda: both.write("once\n"))
        in_a_thread(lambda: print("twice", file=sys.stdout))
    assert told == ["once", "twice"]
    assert vars(both)["write"] is own_write
    assert (sys.stdout, sys.stderr) == (both, both)


def test_a_stream_that_lets_nobody_change_it_is_heard_by_its_name(
    monkeypatch: pytest.MonkeyPatch, told: list[str]
) -> None:
    own = Unchangeable()
    monkeypatch.setattr(sys, "stdout", own)
    with CapturedOutput(lambda line, _: told.append(line)):
        in_a_thread(lambda: print("hello"))
        print("a demonstration")
    assert told == ["hello"]
    assert own.getvalue() == "a demonstration\n"
    assert sys.stdout is own


def test_a_log_line_that_nobody_is_shown_is_not_told(told: list[str]) -> None:
    log = get_logger("listener")

    def say() -> None:
        log.debug("below the level")
        for text in ("one", "two"):
            log.info(text, once=True)

    with CapturedOutput(lambda line, _: told.append(line)):
        in_a_thread(say)
    assert told == ["one"]


@pytest.mark.ros
def test_a_listener_with_a_logger_of_pythons_own_passes(checked: Checked) -> None:
    log = logging.Logger("listener")
    log.addHandler(logging.StreamHandler(sys.stderr))

    class ListenerNode(Node):
        def __init__(self) -> None:
            super().__init__("listener_node")
            self.create_subscription(String, "chatter", self.hear, 10)

        def hear(self, message: String) -> None:
            log.warning("I heard: %s", message.data)

    verdict = checked("lab_1_2.listener", ListenerNode)
    assert verdict.score == verdict.max_score


@pytest.mark.ros
def test_a_listener_that_logs_at_a_level_that_is_not_shown_says_nothing(checked: Checked) -> None:
    class ListenerNode(Node):
        def __init__(self) -> None:
            super().__init__("listener_node")
            self.create_subscription(String, "chatter", self.hear, 10)

        def hear(self, message: String) -> None:
            self.get_logger().debug(message.data)  # type: ignore[no-untyped-call]

    verdict = checked("lab_1_2.listener", ListenerNode)
    assert verdict.diagnosis is not None
    assert verdict.diagnosis.key == "not_logged"
    assert "debug(...) are not shown" in verdict.diagnosis.next_step


def test_a_subject_that_asks_for_input_finds_none_and_the_front_end_shows_no_box(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    class Kernel:
        """As in ipykernel: ``input()`` and ``getpass()`` ask the front end, which waits for an answer."""

        def _input_request(self, prompt: str) -> str:
            return f"an answer to {prompt}"

    kernel, ended = Kernel(), list[str]()
    monkeypatch.setattr(subject_reports, "notebook_shell", lambda: SimpleNamespace(kernel=kernel))

    def subject() -> None:
        try:
            kernel._input_request("Your name?")
        except EOFError as error:
            ended.append(str(error))

    with CapturedOutput(lambda *_: None):
        in_a_thread(subject)
        assert kernel._input_request("another cell") == "an answer to another cell"
    assert ended == ["EOF when reading a line"]
    assert "_input_request" not in vars(kernel)


LOOPING = """def work(over):
    while not over.is_set():
        sum(range(100))
"""


def test_a_stack_quotes_the_loop_of_the_student_and_counts_its_processor_time(tmp_path: Path) -> None:
    file, names, over = tmp_path / "cell.py", dict[str, Any](), threading.Event()
    file.write_text(LOOPING)
    exec(compile(LOOPING, str(file), "exec"), names)
    captured = CapturedOutput(lambda *_: None)
    thread = threading.Thread(target=names["work"], args=(over,), daemon=True)
    thread.start()
    waiting = threading.Thread(target=over.wait, daemon=True)
    waiting.start()
    try:
        while (told := captured.stacks())[1] <= 0.0:
            pass
    finally:
        over.set()
    assert f"Thread {thread.ident:#x} in the loop of line 2: while not over.is_set(): (most recent" in told[0]
    assert f"Thread {waiting.ident:#x} (most recent" in told[0]
    assert "autograder" not in told[0]


DEEP = """def deep(left, over):
    if left:
        return deep(left - 1, over)
    while not over.wait(600.0):
        pass
"""


def test_a_deep_stack_shows_both_ends_and_each_line_is_looked_up_once(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    parsed: list[str] = []

    def parse(text: str) -> ast.Module:
        parsed.append(text)
        return ast.parse(text)

    monkeypatch.setattr(own_lines, "_parsed", parse)
    file, names, over = tmp_path / "cell.py", dict[str, Any](), threading.Event()
    file.write_text(DEEP)
    exec(compile(DEEP, str(file), "exec"), names)
    captured = CapturedOutput(lambda *_: None)
    threads = [threading.Thread(target=names["deep"], args=(700, over), daemon=True) for _ in range(20)]
    for thread in threads:
        thread.start()
    try:
        # Not by the stacks: a thread may have the number of one that ended, and is left out then.
        while {sys._current_frames()[thread.ident or 0].f_code.co_name for thread in threads} != {"wait"}:
            pass
        stacks = captured.stacks()[0].split("Thread ")[1:]
    finally:
        over.set()
    assert stacks
    assert all(stack.count("\n") <= 2 * MOST_CALLS + 1 for stack in stacks)
    assert all("in wait\n" in stack and "in run\n" in stack for stack in stacks)
    assert 1 <= len(parsed) <= len(DEEP.splitlines())


WAITS = cases(__file__, "WAITS")


@pytest.mark.parametrize(
    ("condition", "ends"), cases(__file__, "an_attribute_that_another_method_sets_may_end_a_loop")
)
def test_an_attribute_that_another_method_sets_may_end_a_loop(
    condition: str, ends: bool, tmp_path: Path
) -> None:
    text = WAITS.replace("{condition}", condition)
    file, names, over = tmp_path / "cell.py", dict[str, Any](), threading.Event()
    file.write_text(text)
    exec(compile(text, str(file), "exec"), names)

    def wait(seconds: float) -> None:
        if over.wait(seconds):
            raise SystemExit

    captured = CapturedOutput(lambda *_: None)
    dock = names["Dock"](SimpleNamespace(wait=wait))

    def run() -> None:
        with suppress(SystemExit):
            dock.dock()

    threading.Thread(target=run, daemon=True).start()
    try:
        while "loop of line" not in (told := captured.stacks()[0]):
            pass
    finally:
        over.set()
    assert f"line 17: while {condition}:{own_lines.ENDLESS if ends else ''} (most" in told
