"""A card that names nothing says which input it was, what came, what the task asks for, and where the task says it."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from autograder.kit.evidence import Event, Evidence, Part, Reference
from autograder.kit.oracle.naming.located import located
from autograder.kit.oracle.outputs import NUMBER, Kind, Output
from autograder.kit.oracle.same_as_solution import SameAsSolution

SAID = Output("/said", ("data",), Kind.STEPS, 1e-3)
MOVED = Output("/moved", ("linear.x", "angular.z"), Kind.STEPS, 1e-3)
LAW = {"say far or near": "said", "drive with 0.5": "moved", "stand still where it is near": "moved"}


def run(said: list[str], moved: list[float]) -> Part:
    events = []
    for step, (word, speed) in enumerate(zip(said, moved, strict=True), 1):
        events.append(Event(0.0, "sent", "/scan", {"fields": {"ranges": [step / 10, 2.0, 2.0, 2.0, 2.0]}}))
        for output, value in (("/said", [word]), ("/moved", [speed, 0.0])):
            data: dict[str, Any] = {"step": step, "given": "/scan", "values": [value]}
            events.append(Event(0.0, "noted", output, data))
    return Part("drawing 0", {}, events)


DUE = run(["far", "near", "far"], [0.5, 0.0, 0.5])


def told(seen: Part, near: str = "") -> str:
    advice = located([SAID, MOVED], seen, DUE, LAW, near)
    return advice.text if advice else ""


def test_the_input_and_only_what_differs_are_named() -> None:
    text = told(run(["far", "near", "nothing"], [0.5, 0.0, 0.5]))
    assert text == (
        "After /scan with ranges = [0.3, 2, 2, …], your code says on /said: “nothing”; the task asks for “far”. "
        "The task says: “say far or near”."
    )
    assert "angular" not in told(run(["far", "near", "far"], [0.5, 0.2, 0.5]))


def test_the_earliest_step_is_named_whatever_the_order_of_the_outputs_is() -> None:
    assert "on /moved: angular.z" not in told(run(["far", "near", "nothing"], [0.5, 0.0, 0.2]))
    assert told(run(["far", "near", "nothing"], [0.5, 0.2, 0.5])).startswith(
        "After /scan with ranges = [0.2, 2, 2, …], your code says on /moved: linear.x = 0.2"
    )


def test_where_only_time_has_passed_the_last_input_is_named() -> None:
    wait = Event(0.0, "noted", "/said", {"step": 4, "given": "0.5 s without an input", "values": [["late"]]})
    more = Event(
        0.0, "noted", "/said", {"step": 5, "given": "0.25 s without an input", "values": [["nothing"]]}
    )
    due = replace(more, data={**more.data, "values": [["far"]]})
    seen, asked = (replace(DUE, events=[*DUE.events, wait, last]) for last in (more, due))
    advice = located([SAID], seen, asked, LAW)
    assert advice is not None
    assert advice.text.startswith(
        "After /scan with ranges = [0.3, 2, 2, …], then 0.75 s without an input, your code says on /said: “nothing”"
    )


def test_of_several_sentences_the_likely_one_is_quoted() -> None:
    seen = run(["far", "near", "far"], [0.5, 0.5, 0.5])
    assert "The task says" not in told(seen)
    assert "stand still where it is near" in told(seen, "stand still where it is near")
    assert told(DUE) == ""


def test_an_input_that_came_before_the_judge_listened_is_named() -> None:
    """The input of a step is the next one, and of two maps each cell that differs is shown."""
    output = Output("/map", ("data", NUMBER), Kind.STEPS, 1e-3)

    def mapped(*cells: int) -> Part:
        walls = [Event(0.0, "sent", "/wall", {"fields": {"x": 0.5 + cell}}) for cell in range(2)]
        values = [[[100 * (place == cell) for place in range(9)], 2] for cell in cells]
        noted = [
            Event(0.0, "noted", "/map", {"step": step, "given": "/wall" * step, "values": [one]})
            for step, one in enumerate(values)
        ]
        return Part("drawing 0", {}, [*walls, *noted])

    for seen, wall in ((mapped(6, 2), 0.5), (mapped(5, 6), 1.5)):
        advice = located([output], seen, mapped(5, 2), {})
        assert advice is not None
        places = ("5", "6") if wall == 0.5 else ("2", "6")
        assert advice.text == (
            f"After /wall with x = {wall}, your code says on /map: “0 at index {places[0]}, 100 at index {places[1]}”; "
            f"the task asks for “100 at index {places[0]}, 0 at index {places[1]}”."
        )


def test_a_callback_that_crashed_is_named_with_the_first_input_that_shows_it() -> None:
    """A wrong index may be too large only later, and what came before says more than the crash."""
    frames = ("/x/rclpy/executors.py", "/home/student/a.py")
    lines = [
        "Traceback (most recent call last):",
        *(f'  File "{file}", line 9, in on_scan' for file in frames),
    ]
    crash = [Event(0.0, "output", "stderr", {"text": line}) for line in (*lines, "IndexError: out of range")]
    seen = run(["far", "far", "far"], [0.5, 0.0, 0.5])
    interface = {"publisher": {"/said": "x/msg/Y"}, "subscription": {"/scan": "x/msg/Y"}}
    evidence = Evidence([replace(seen, events=[*seen.events, *crash])], Reference("a.b", interface, [DUE]))
    tells: dict[str, str | tuple[str, ...]] = {"/said": "data", "/moved": ("linear.x", "angular.z")}
    exercise = SameAsSolution("a.b", "A", "B", gives=lambda random: [random.random()], tells=tells).exercise()
    found = (one.recognize(evidence) for one in exercise.mistakes if one.key == "exception_in_callback")
    (advice,) = filter(None, found)
    assert "After /scan with ranges = [0.2, 2, 2, …], your code says on /said: “far”" in advice.text


def test_of_several_messages_in_a_step_only_what_differs_is_shown() -> None:
    """What came rightly before is counted: a card has no room for a page of texts."""

    def asks(*texts: str) -> Part:
        noted = {"step": 1, "given": "/order", "values": [[text] for text in texts]}
        return Part("drawing 0", {}, [Event(0.0, "noted", "/asked", noted)])

    output = Output("/asked", ("data",), Kind.STEPS, 1e-3)
    due = asks("one", "two", "three", "four")
    for seen, came in (
        (asks("one", "two"), "says nothing on /asked"),
        (asks("one", "two", "2"), "says on /asked: “2”"),
    ):
        advice = located([output], seen, due, {})
        assert advice is not None
        assert (
            advice.text
            == f"After /order, then 2 messages as asked, your code {came}; the task asks for “three”."
        )


def test_the_only_sentence_that_quotes_what_is_too_much_is_shown() -> None:
    law = {"say `far`": "said", "give up, and say `nothing`": "said"}
    seen, due = (
        Part("a", {}, [Event(0.0, "noted", "/said", {"step": 1, "given": "/go", "values": [[word]]})])
        for word in ("nothing", "near")
    )
    advice = located([SAID], seen, due, law)
    assert advice is not None
    assert advice.text.endswith("The task says: “give up, and say `nothing`”.")


def test_of_long_lists_only_the_items_that_differ_are_shown() -> None:
    begins = "Find my glasses; " + "{'tool': 'walk_to'} -> ok; " * 2
    seen, due = (
        Part("a", {}, [Event(0.0, "noted", "/said", {"step": 1, "given": "/go", "values": [[begins + end]]})])
        for end in ("lamp -> error", "lamp -> ok")
    )
    advice = located([SAID], seen, due, LAW)
    assert advice is not None
    assert "your code says on /said: … lamp -> error”; the task asks for … lamp -> ok”." in advice.text
