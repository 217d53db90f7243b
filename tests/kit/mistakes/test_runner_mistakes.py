"""A runner brings its mistakes: a build's come first, and no card of a launch file speaks of main()."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from autograder.kit.draft import Draft
from autograder.kit.evidence import Event, Evidence, Part, Reference
from autograder.kit.output.launched_processes import Process, process_line
from autograder.kit.recipes.own_scenario import OwnScenario
from autograder.kit.runners import Launches, RunsProgram

if TYPE_CHECKING:
    from autograder.kit.model import Exercise
    from autograder.kit.runners import Runner

REFERENCE = Reference("lab.fleet", {"publisher": {"/left/speed": "x/msg/Y"}})


def exercise(runner: Runner | None = None) -> Exercise:
    """An own scenario, whose author lists no mistake."""
    return Draft("lab.fleet", "A", "B", OwnScenario(lambda _: None, "publisher")).exercise(runner=runner)


def printed(*lines: str, ended: bool = True) -> Evidence:
    """A run that printed these lines."""
    events = [Event(0.1, "output", "stdout", {"text": line}) for line in lines]
    end = [Event(0.2, "subject", "exited", {"code": 0})] if ended else []
    return Evidence([Part("met", {}, [*events, *end])], REFERENCE)


def diagnosed(runner: Runner | None, evidence: Evidence) -> tuple[str, str]:
    """The key of the first mistake that fits, and both of its texts."""
    for known in exercise(runner).mistakes:
        if (advice := known.recognize(evidence)) is not None:
            return known.key, f"{advice.text} {advice.next_step}"
    return "", ""


STARTED = process_line(Process(7, 1, ("python3", "cruise", "--ros-args")))


@pytest.mark.parametrize(
    ("lines", "key", "words"),
    [
        (
            ("[ERROR] [launch]: executable 'cruiser' not found",),
            "launch_error",
            "`ros2 pkg executables` lists",
        ),
        (
            ("[ERROR] [launch]: SyntaxError: invalid syntax",),
            "syntax_error",
            "Python could not read the launch file",
        ),
        ((), "nothing_on_the_graph", "The launch file started no program."),
        ((STARTED,), "nothing_on_the_graph", "no node appeared"),
    ],
    ids=["an unknown program", "not Python", "nothing started", "started, without a node"],
)
def test_a_launch_file_has_mistakes_of_its_own(lines: tuple[str, ...], key: str, words: str) -> None:
    found, text = diagnosed(Launches(), printed(*lines))
    assert (found, words in text) == (key, True)
    assert "main()" not in text
    assert "rclpy.init" not in text


def test_a_program_keeps_the_mistakes_of_programs() -> None:
    for runner in (None, RunsProgram("fleet_pkg", "cruise")):
        assert diagnosed(runner, printed())[0] == "main_guard"


def test_what_is_built_has_the_mistakes_of_a_build() -> None:
    assert "build_failed" not in {known.key for known in exercise().mistakes}
    for runner in (Launches(), RunsProgram("fleet_pkg", "cruise")):
        keys = [known.key for known in exercise(runner).mistakes]
        assert keys.count("build_failed") == 1
        assert keys.index("build_failed") < keys.index("topic_name")
