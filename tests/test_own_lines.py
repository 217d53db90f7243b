"""The lines of a student's code that a card may quote: found without running the code."""

from __future__ import annotations

import subprocess
from typing import TYPE_CHECKING

import msgspec
import pytest

from autograder.messages.judge_messages import OwnLines
from autograder.own_lines import (
    ENDLESS,
    LONGEST_LINE,
    MOST_NAMES,
    MOST_OF_A_NAME,
    UNLEFT,
    loop_around,
    own_lines,
)
from course_runtime.python_child import python_child
from tests.cases import cases

if TYPE_CHECKING:
    from pathlib import Path

TALKER = cases(__file__, "TALKER")


def lines(name: str, **sources: str) -> list[tuple[str, int, str]]:
    found = own_lines({place.replace("_", " "): text for place, text in sources.items()}).lines
    return [(line.place, line.number, line.text) for line in found if line.name == name]


def test_a_line_is_found_by_each_name_that_it_uses() -> None:
    assert lines("publish", your_cell=TALKER) == [("your cell", 8, "self.publisher.publish(message)")]
    assert lines("ready", your_cell=TALKER) == [("your cell", 7, "if self.ready():")]
    assert lines("Node", your_cell=TALKER) == []


def test_a_call_on_several_lines_is_quoted_whole() -> None:
    assert lines("create_timer", your_cell=TALKER) == [
        ("your cell", 3, "self.timer = self.create_timer( 5.0, self.tick)")
    ]


def test_a_method_that_is_passed_and_not_called_is_used_too() -> None:
    assert lines("publish", your_cell="say = node.publisher.publish") == [
        ("your cell", 1, "say = node.publisher.publish")
    ]


def test_of_a_tool_that_was_given_the_line_that_calls_it_comes_first() -> None:
    tool = "def ask(node, client):\n    return client.call_async(1)\n"
    assert lines("call_async", your_cell="def f():\n    ask(1, 2)\n", other=tool) == [
        ("your cell", 2, "ask(1, 2)"),
        ("other", 2, "return client.call_async(1)"),
    ]


def test_what_cannot_be_parsed_or_is_too_long_has_no_lines() -> None:
    assert own_lines({"your cell": "def ("}).lines == []
    assert own_lines({"your cell": "(" * 100_000}).lines == []
    assert own_lines({"your cell": "f()\n" * 100_000}).lines == []
    assert own_lines({"your cell": "\n".join(f"f{n}()" for n in range(MOST_NAMES + 1))}).lines == []


def test_long_lines_and_many_lines_are_cut() -> None:
    found = own_lines({"your cell": f"f({'1' * 500})\n" * 50}).lines
    assert [len(line.text) for line in found] == [LONGEST_LINE] * MOST_OF_A_NAME


def test_a_process_reads_the_files_of_a_program_and_runs_none(tmp_path: Path) -> None:
    (tmp_path / "talker.py").write_text("node.create_timer(exit(1))\n", encoding="utf-8")
    reader = python_child("-m", "autograder.own_lines", f"{tmp_path}/talker.py", f"{tmp_path}/missing.py")
    output = subprocess.run(reader.command, env=reader.environment, capture_output=True, check=True).stdout
    (line, *_) = msgspec.json.decode(output, type=OwnLines).lines
    assert (line.name, line.place, line.number) == ("create_timer", "talker.py", 1)


LOOPS = """def dock(self, goal):
    for scan in goal.scans:
        while left > 0.0:
            self.forward()
        self.stop()
    return left
"""


@pytest.mark.parametrize(("line", "loop"), cases(__file__, "the_innermost_loop_around_a_line_is_quoted"))
def test_the_innermost_loop_around_a_line_is_quoted(line: int, loop: str) -> None:
    assert loop_around(LOOPS, line) == loop


@pytest.mark.parametrize(
    ("old", "new", "endless"), cases(__file__, "a_loop_is_endless_only_if_no_line_ends_it")
)
def test_a_loop_is_endless_only_if_no_line_ends_it(old: str, new: str, endless: bool) -> None:
    text = "def dock():\n    def drive(left, goal):\n        n = 1\n        while left > 0.0:\n            pass\n"
    assert old in text
    quoted = loop_around(text.replace(old, new), 5, frozenset({"left", "n"}))
    assert quoted.endswith(ENDLESS) is endless


@pytest.mark.parametrize(
    ("text", "ends"),
    [
        *cases(__file__, "a_loop_over_attributes_is_endless_only_if_no_other_function_sets_them"),
        ("while self.left > 0.0:\n    self.forward()", ENDLESS),
        ("while self.left:\n    self.forward()", ENDLESS),
        ("while True:\n    self.forward()", UNLEFT),
        ("while 1:\n    self.left -= 0.25", UNLEFT),
    ],
)
def test_a_loop_over_attributes_is_endless_only_if_no_other_function_sets_them(text: str, ends: str) -> None:
    quoted = loop_around(text, 2, frozenset({"self.left"}))
    assert quoted == f"1: {text.splitlines()[0]}{ends}"


def test_code_that_cannot_be_read_has_no_loop() -> None:
    assert loop_around("while True", 1) == ""
