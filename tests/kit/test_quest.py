"""A quest reads what a subject says of the robot that the judge drew, and knows who looked once or only guessed."""

from __future__ import annotations

from dataclasses import replace
from random import Random
from typing import TYPE_CHECKING, Any
from unittest.mock import MagicMock

import pytest

from autograder.judge.verdicts import deciding
from autograder.kit.bench import Pace
from autograder.kit.draft import Draft
from autograder.kit.evidence import Event, Evidence, Part, Reference
from autograder.kit.quests.quest import ACCEPTED, Quest
from autograder.kit.quests.robot import Robot, Search
from tests.cases import cases

if TYPE_CHECKING:
    from autograder.kit.model import Exercise

TWIST, POINT, TRIGGER = "geometry_msgs/msg/Twist", "geometry_msgs/msg/Point", "std_srvs/srv/Trigger"
MIA = Robot(
    answer={"robot": "/mia", "topic": "/mia/go"},
    nodes={
        "/mia/motors": {"subscribes": {"/mia/go": TWIST}},
        "/mia/arm": {"subscribes": {"/mia/reach": POINT}},
    },
)
SAID = "{'robot': '/mia', 'topic': '/mia/go'}"


def obeys() -> Exercise:
    """A quest about two robots, in the fewest words."""

    def robots(random: Random) -> dict[str, Robot]:
        drawn = {}
        for number, called in enumerate(random.sample(("mia", "noa", "ada"), 2)):
            topic = f"/{called}/{random.choice(('go', 'drive', 'steer'))}"
            nodes = {f"/{called}/motors": {"subscribes": {topic: TWIST}}}
            drawn[f"robot {number}"] = Robot(answer={"robot": called, "topic": topic}, nodes=nodes)
        return drawn

    finds = {"robot": "Finds what it is called", "topic": "Finds the topic that it obeys"}
    return Quest(robots).exercise("a.b", "A", "B", finds=finds)


def test_each_key_of_the_answer_is_a_criterion_and_a_printed_dictionary_counts() -> None:
    exercise = obeys()
    assert [(one.name, one.title, one.points) for one in exercise.criteria] == [
        ("robot", "Finds what it is called", 5),
        ("topic", "Finds the topic that it obeys", 5),
    ]
    assert exercise.counts_as_a_whole == ACCEPTED


def part(robot: Robot, *said: str, name: str = "", at: float = 5.0, ending: str = "exited") -> Part:
    """Return a run in which a program met a robot, printed these lines, and ended."""
    lines = [Event(1.0, "output", "stdout", {"text": line}) for line in said]
    ends = [Event(at, "subject", ending, {"code": 0})] if ending else []
    return Part(name, vars(robot), [Event(0.2, "interface", "graph", {"nodes": ["/me"]}), *lines, *ends])


@pytest.mark.parametrize("said", cases(__file__, "a_dictionary_counts_however_it_is_printed"))
def test_a_dictionary_counts_however_it_is_printed(said: tuple[str, ...]) -> None:
    search = Search(part(MIA, *said))
    assert search.has()
    assert search.has_answered


@pytest.mark.parametrize(
    "topic", ["['/mia/go', '/mia/reach']", "{'/mia/reach', '/mia/go'}", "'\\ud83d'", "0x" + "f" * 3800, "go"]
)
def test_several_names_or_none_are_no_answer(topic: str) -> None:
    search = Search(part(MIA, f"{{'robot': '/mia', 'topic': {topic}}}"))
    assert search.has("robot")
    assert "topic" not in search.given


def test_a_type_may_be_written_as_python_imports_it() -> None:
    robot = Robot(answer={"topic": "/go", "type": TWIST})
    assert Search(part(robot, "{'topic': 'go', 'type': 'geometry_msgs.msg.Twist'}")).has()
    assert not Search(part(robot, "{'topic': 'go', 'type': 'std_msgs/msg/Twist'}")).has("type")


@pytest.mark.parametrize(
    ("said", "is_right"), [("/nova/base", True), ("nova/base", True), ("base", True), ("nova", False)]
)
def test_a_node_may_be_named_without_its_namespace(said: str, is_right: bool) -> None:
    nodes = {"/nova/base": {"subscribes": {"/nova/go": TWIST}}}
    robot = Robot(answer={"robot": "/nova/base", "topic": "/nova/go"}, nodes=nodes)
    search = Search(part(robot, f"{{'robot': '{said}', 'topic': 'go'}}"))
    assert search.has("robot") is is_right
    assert not search.has("topic")


OPEN = Robot(
    answer={"name": "/mia/open"}, services={"/mia/open": TRIGGER, "/mia/open_all": TRIGGER, "/z": TRIGGER}
)


@pytest.mark.parametrize(("said", "given"), cases(__file__, "a_single_name_is_the_last_that_stands_alone"))
def test_a_single_name_is_the_last_that_stands_alone(said: list[str], given: str) -> None:
    search = Search(part(OPEN, *said))
    assert search.given.get("name", "") == given
    assert search.has() is (given == "/mia/open")


def test_a_name_may_be_no_node_s_and_no_topic_s() -> None:
    robot = Robot(answer={"robot": "mia"}, nodes=MIA.nodes)
    assert Search(part(robot, "it has /mia/motors", "it is called mia")).has()
    assert not Search(part(robot, "it has /mia/motors")).has()


@pytest.mark.parametrize(
    ("said", "given"),
    [(["it is /z"], ["/z"]), (["not available, I see only /z"], []), (["I see /z", "nothing"], [])],
)
def test_who_reports_that_there_is_none_may_name_what_there_is(said: list[str], given: list[str]) -> None:
    search = Search(part(Robot(services={"/z": TRIGGER}), *said))
    assert list(search.given.values()) == given


def _judged(exercise: Exercise, *parts: Part) -> tuple[float, str]:
    """Return the points and the diagnosis."""
    evidence = Evidence(parts, Reference("a.b", {}))
    points = sum(criterion.points for criterion in exercise.criteria if criterion.judge(evidence).passed)
    diagnosis, _ = deciding.diagnose(exercise, evidence)
    return points, diagnosis.key


NOA = Robot(
    answer={"robot": "noa", "topic": "/noa/drive"},
    nodes={"/noa/motors": {"subscribes": {"/noa/drive": TWIST}}},
)
NOA_SAID = "{'robot': 'noa', 'topic': '/noa/drive'}"


@pytest.mark.parametrize(
    ("first", "second", "points", "key"),
    [
        *cases(__file__, "an_answer_has_to_be_right_for_each_robot"),
        ([SAID], None, 0, ""),
        ([SAID], [NOA_SAID.replace("'noa'", "'/mia'")], 5, "invented_answer"),
        ([SAID], [NOA_SAID.replace("'noa'", "'/rosout'")], 5, ""),
        ([SAID], [NOA_SAID.replace("'topic'", "'name'")], 5, "no_answer"),
    ],
)
def test_an_answer_has_to_be_right_for_each_robot(
    first: list[str], second: list[str] | None, points: float, key: str
) -> None:
    seen = [part(MIA, *first, name="robot 0")]
    seen += [part(NOA, *second, name="robot 1")] if second is not None else []
    judged = _judged(obeys(), *seen)
    assert judged[0] == points
    assert key in ("", judged[1])


def test_a_subject_that_stays_without_an_answer_never_ended() -> None:
    stays = part(MIA, "still looking", name="robot 0", ending="")
    assert _judged(obeys(), stays) == (0, "never_ended")


@pytest.mark.parametrize(
    ("said", "made"), [([SAID], 2), (["no idea"], 1)], ids=["an answer", "no answer, so no point is left"]
)
def test_a_subject_meets_further_robots_only_while_points_are_left(said: list[str], made: int) -> None:
    seen = part(MIA, *said)
    bench = MagicMock(pace=Pace.FAST, random=Random(0), seen=lambda: seen, keep=lambda _: False)
    Quest(lambda _: {"one": MIA, "other": NOA}).scenario(bench)
    assert bench.part.call_count == made


def doors() -> Exercise:
    """A quest with a service that comes late, one that is there, and none."""
    quest = Quest(
        lambda _: {"late": late(), "there": OPEN, "none": Robot(services={"/z": TRIGGER})}, "service"
    )
    draft = Draft("a.b", "A", "B", quest)
    draft.asks("late", "Finds a late one", quest.finds(robot="late"), points=4)
    draft.asks("there", "Finds one", quest.finds(robot="there"), points=3)
    draft.asks("none", "Says so", quest.says_that_there_is_none, points=3)
    return draft.exercise()


def late() -> Robot:
    return Robot(answer=OPEN.answer, services=OPEN.services, late=["/mia/open"])


@pytest.mark.parametrize(
    ("said", "at", "points", "key"), cases(__file__, "who_looks_once_finds_only_by_chance")
)
def test_who_looks_once_finds_only_by_chance(
    said: tuple[str, ...], at: float, points: float, key: str
) -> None:
    robots = (late(), OPEN, Robot(services={"/z": TRIGGER}))
    names = ("late", "there", "none")
    parts = [part(r, line, name=name, at=at) for r, line, name in zip(robots, said, names, strict=True)]
    judged = _judged(doors(), *parts)
    assert judged[0] == points
    assert key in ("", judged[1])


def test_a_notebook_s_function_has_to_return_what_it_names() -> None:
    def told(value: Any) -> tuple[float, str]:
        ended = Event(5.0, "subject", "returned", {"value": value})
        parts = [
            Part(name, vars(robot), [*part(robot, "/mia/open", ending="").events, ended])
            for name, robot in (("late", late()), ("there", OPEN))
        ]
        return _judged(doors(), *parts)

    assert told("'mia/open'")[0] == 7
    assert told("('/mia/open', 1)") == (0, "not_returned")


def test_a_function_that_prints_the_name_and_raises_has_returned_nothing() -> None:
    said = part(OPEN, "/mia/open", name="there", ending="")
    started = Event(0.1, "subject", "started", {"accepted": []})
    assert not Search(replace(said, events=[started, *said.events])).has_answered
    raised = Event(8.0, "subject", "raised", {"traceback": "TimeoutError: nobody"})
    assert not Search(replace(said, events=[started, *said.events, raised])).returned


@pytest.mark.parametrize(("ending", "points"), [("raised", 0), ("returned", 10)])
def test_a_function_may_print_its_dictionary_but_not_raise_after_it(ending: str, points: float) -> None:
    """Whoever calls it gets the error, and no answer."""
    started = Event(0.1, "subject", "started", {"accepted": []})
    parts = [part(MIA, SAID, name="robot 0", ending=""), part(NOA, NOA_SAID, name="robot 1", ending="")]
    assert not Search(replace(parts[0], events=[started, *parts[0].events])).has_answered
    ended = Event(8.0, "subject", ending, {"value": "None", "traceback": "TimeoutError: nobody"})
    judged = _judged(obeys(), *(replace(one, events=[started, *one.events, ended]) for one in parts))
    assert judged[0] == points


NOBODY = Robot(nodes=NOA.nodes)
RAISED = {"traceback": 'Traceback (most recent call last):\n  File "x"\nTimeoutError: no node obeys'}


def limited(*said: str, ending: tuple[str, dict[str, Any]], at: float = 0.6) -> Part:
    """Return a run of a function that was told to wait for 0.45 s, and for which there was nothing to find."""
    start = Event(0.0, "subject", "started", {"accepted": ["patience_sec"]})
    lines = [Event(0.1, "output", "stdout", {"text": line}) for line in said]
    return Part(
        "none", {**vars(NOBODY), "patience_sec": 0.45}, [start, *lines, Event(at, "subject", *ending)]
    )


@pytest.mark.parametrize(
    ("run", "fault"),
    [
        (limited("looking at /noa/motors", ending=("raised", RAISED)), ""),
        (
            limited(ending=("raised", {"traceback": "RuntimeError: no robot"})),
            "raised RuntimeError: no robot",
        ),
        (limited(ending=("returned", {"value": "None"})), "returned None"),
        (limited(ending=("raised", RAISED), at=0.05), "gave up after 0.1 s, although patience_sec was 0.45"),
        (limited(ending=("raised", RAISED), at=8.0), "gave up after 8.0 s, although patience_sec was 0.45"),
        (part(NOBODY, "None", name="none"), ""),
        (part(NOBODY, NOA_SAID, name="none"), "named noa, /noa/drive"),
        (part(NOBODY, "looking", name="none", ending=""), "still looking after 12 s"),
        (Part("none"), "not reached"),
    ],
)
def test_a_function_raises_timeout_error_if_there_is_nothing_and_a_program_ends(
    run: Part, fault: str
) -> None:
    assert Search(run).limit_fault == fault


def test_who_finds_nothing_anywhere_has_not_given_up() -> None:
    quest = Quest(lambda _: {"there": MIA, "none": NOBODY})
    exercise = quest.exercise(
        "a.b", "A", "B", finds={"robot": "Finds it", "topic": "And its topic"}, gives_up="Gives up"
    )
    assert [criterion.points for criterion in exercise.criteria] == [4, 4, 2]
    none = limited(ending=("raised", RAISED))
    assert _judged(exercise, part(MIA, SAID, name="there"), none)[0] == 10
    assert _judged(exercise, part(MIA, "nobody", name="there"), none)[0] == 0
    returns = limited(ending=("returned", {"value": "None"}))
    assert _judged(exercise, part(MIA, SAID, name="there"), returns) == (8, "silent_end")


@pytest.mark.parametrize(("in_a_cell", "late"), [(True, ["/mia/motors"]), (False, [])])
def test_only_a_function_is_made_to_wait_for_what_comes_late(in_a_cell: bool, late: list[str]) -> None:
    seen = part(MIA, SAID)
    bench = MagicMock(
        pace=Pace.FAST, random=Random(0), seen=lambda: seen, keep=lambda _: False, in_a_cell=in_a_cell
    )
    bench.await_end.return_value = True
    quest = Quest(lambda _: {"one": replace(MIA, late=["/mia/motors"]), "none": NOBODY})
    quest.exercise("a.b", "A", "B", finds={"robot": "Finds it"}, gives_up="Gives up")
    quest.scenario(bench)
    first = bench.part.call_args_list[0].kwargs
    assert list(first["late"]) == late
    assert first["patience_sec"] >= 4


def test_a_slow_subject_s_time_begins_with_its_own_node_not_with_the_robot_s() -> None:
    nodes = ["/mia/arm", "/mia/motors"]
    surveys = [Event(0.2, "interface", "graph", {"nodes": nodes})]
    surveys += [Event(4.0, "interface", "graph", {"nodes": ["/finder", *nodes]})]
    search = Search(Part("", vars(MIA), [*surveys, Event(5.0, "subject", "exited", {"code": 0})]))
    assert search.since_it_appeared.events[0].t == 4.0
    assert search.gave_up_at_once
