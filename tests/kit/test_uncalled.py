"""A method that nobody calls is named if its name is almost that of one that the task has."""

from __future__ import annotations

from autograder.kit.evidence import Evidence, Part, Reference
from autograder.kit.mistakes.uncalled import METHOD_UNCALLED, uncalled
from autograder.messages.judge_messages import OwnLine

METHODS = ["on_command", "on_silence"]


def line(name: str, place: str = "your cell") -> OwnLine:
    return OwnLine(name, place, 1, name)


def test_a_method_with_almost_the_right_name_is_named() -> None:
    (event,) = uncalled([line("def on_silent"), line("def on_command")], METHODS)
    advice = METHOD_UNCALLED.recognize(Evidence([Part("a", {}, [event])], Reference("a.b", {})))
    assert advice is not None
    assert "on_silent" in advice.text
    assert "on_silence" in advice.text
    assert advice.uses == ("def on_silent",)


def test_a_method_that_is_used_or_right_or_unlike_is_not_named() -> None:
    assert not uncalled([line("def on_silent"), line("on_silent")], METHODS)
    assert not uncalled([line("def on_silence"), line("def on_command")], METHODS)
    assert not uncalled([line("def on_silent"), line("def on_silence")], METHODS)
    assert not uncalled([line("def stop_the_robot")], METHODS)
    assert METHOD_UNCALLED.recognize(Evidence([Part("a")], Reference("a.b", {}))) is None
