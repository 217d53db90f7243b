"""No point and no diagnosis hangs on the moment in which a program that ends was looked at, or on a lucky guess."""

from __future__ import annotations

import re
from dataclasses import replace
from random import Random
from typing import TYPE_CHECKING

import pytest
from inspecting_services import question
from inspecting_topics import mismatch
from lab_1_2 import listener, talker
from lab_1_3 import client as service_client
from lab_1_4 import client as action_client

from autograder.judge import evidence_files
from autograder.kit.evidence import Event, Evidence, Part, Reference
from autograder.kit.goal_reports import LATE, left_at_once
from autograder.kit.mistakes import common_mistakes as common
from autograder.kit.mistakes import unfinished
from autograder.kit.mistakes.goal_mistakes import ENDED_TOO_EARLY, RESULT_NOT_REQUESTED
from autograder.kit.quests.robot import Search
from autograder.kit.recipes.service_client import ANSWER_NOT_AWAITED
from autograder.kit.reported_texts import has_much_of
from autograder.kit.service_calls import BIASED, CALLED, EXTREME
from tests.cases import cases

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from autograder.kit.quests.robot import Robot

TOPIC, TYPE = "/chatter", "std_msgs/msg/String"
EXITED = Event(9.0, "subject", "exited", {"code": 1})
TRACEBACK = (
    "Traceback (most recent call last):",
    '  File "/home/student/talker.py", line 3, in <module>',
    "    with TalkerNode() as node:",
    "AttributeError: 'NoneType' object has no attribute 'spin'",
)


def _interface(role: str) -> Event:
    return Event(0.2, "interface", "graph", {"nodes": ["/node"], role: {TOPIC: TYPE}})


def _printed(lines: tuple[str, ...], t: float = 0.3) -> list[Event]:
    return [Event(t, "output", "stderr", {"text": line}) for line in lines]


def _message(number: int) -> Event:
    return Event(
        number * 0.5, "message", TOPIC, {"fields": {"data": f"Hello, world! {number - 1}"}, "number": number}
    )


def _points(module: object, evidence: Evidence) -> float:
    exercise = module.EXERCISE  # type: ignore[attr-defined]
    return sum(c.points for c in exercise.criteria if c.judge(evidence).passed)


TALKER = Reference(
    "lab_1_2.talker",
    {"publisher": {TOPIC: TYPE}},
    [Part("talking", {}, [Event(e.t, e.kind, e.name, e.data, e.t) for e in map(_message, range(1, 21))])],
)


@pytest.mark.parametrize("seen", [[], [_interface("publisher")], [_interface("publisher"), _message(1)]])
def test_a_talker_that_dies_at_once_earns_the_same_whatever_was_seen_of_it(seen: list[Event]) -> None:
    evidence = Evidence([Part("talking", {}, [*seen, *_printed(TRACEBACK), EXITED])], TALKER)
    assert _points(talker, evidence) == 0


def test_one_answer_is_right_in_one_case_at_most() -> None:
    for seed in range(300):
        answers = [robot.answer for robot in mismatch.robots(Random(seed)).values()]
        for key in mismatch.KEYS:
            assert len({answer[key] for answer in answers}) == len(answers)


@pytest.mark.parametrize("takes", [min, max])
def test_who_takes_the_first_or_the_last_topic_of_a_node_is_wrong_in_each_run(
    takes: Callable[[set[str]], str],
) -> None:
    """A node's topics are listed in the order of the alphabet; two of them are those that every node has."""
    for seed in range(300):
        right = [
            takes({robot.answer[key], "/parameter_events", "/rosout"}) == robot.answer[key]
            for robot in mismatch.robots(Random(seed)).values()
            for key in ("topic_published", "topic_subscribed")
        ]
        assert not all(right)


def test_the_names_that_are_told_give_no_topic_away() -> None:
    for seed in range(300):
        for robot in mismatch.robots(Random(seed)).values():
            told = set(re.findall("[a-z]+", " ".join(robot.asked)))
            topics = f"{robot.answer['topic_published']} {robot.answer['topic_subscribed']}"
            assert not told & set(re.findall("[a-z]+", topics))


def test_a_list_of_all_topics_does_not_tell_which_are_whose() -> None:
    robots = [robot for seed in range(300) for robot in mismatch.robots(Random(seed)).values()]
    answers = [robot.answer for robot in robots]
    differ = [answer for answer in answers if answer["topic_published"] != answer["topic_subscribed"]]
    plain = sum(re.fullmatch("/[a-z]+/[a-z]+", answer["topic_published"]) is not None for answer in differ)
    assert 0.4 < plain / len(differ) < 0.8  # one of the wrong names is a plain one, too
    typed = [answer for answer in answers if answer["type_published"] != answer["type_subscribed"]]
    assert 0.4 < sum("std_msgs" in answer["type_published"] for answer in typed) / len(typed) < 0.6
    for robot in robots:
        ends = [ends.get(role, {}) for ends in robot.nodes.values() for role in ("publishes", "subscribes")]
        names = sorted({topic for topics in ends for topic in topics})
        assert set(names[1:-1]) >= {robot.answer["topic_published"], robot.answer["topic_subscribed"]}


def test_the_third_node_has_each_side_s_topic_and_comes_first() -> None:
    for seed in range(300):
        for robot in mismatch.robots(Random(seed)).values():
            third, talker, listener = robot.nodes.values()
            assert list(robot.nodes)[1:] == list(robot.asked)
            assert third["subscribes"].items() > listener["subscribes"].items()
            is_shared = talker["publishes"].keys() == listener["subscribes"].keys()
            assert (third["publishes"].items() > talker["publishes"].items()) is not is_shared


def _questions() -> Iterator[tuple[str, Robot]]:
    """Yield many robots that are drawn for the question, with the names of their runs."""
    for seed in range(300):
        yield from question.robots(Random(seed)).items()


@pytest.mark.parametrize("run", [question.LATE, question.OTHER])
def test_only_its_type_tells_a_service_from_the_others(run: str) -> None:
    guesses = {"second": 0, "last but one": 0, "middle": 0}
    for _, robot in filter(lambda drawn: drawn[0] == run, _questions()):
        right = robot.answer["name"]
        names = sorted(name for name in robot.services if not name.startswith(("/alcove", "/zenith")))
        names.remove(question.TEMPTING[robot.asked[0]])
        assert [name for name, kind in robot.services.items() if kind == robot.asked[0]] == [right]
        assert right not in (names[0], names[-1])
        assert any(name.endswith(question.HIDDEN) for name in names if name != right)
        guesses["second"] += names[1] == right
        guesses["last but one"] += names[-2] == right
        guesses["middle"] += names[len(names) // 2] == right
    assert max(guesses.values()) < 200


def test_a_notebook_s_class_is_held_until_it_is_known() -> None:
    held = Event(0.1, "subject", "constructed")
    evidence = Evidence([Part("talking", {}, [held, _interface("publisher"), EXITED])], TALKER)
    assert _points(talker, evidence) == 3


SAID = [
    Event(number * 0.5, "output", "stdout", {"text": f"Hello, world! {number - 1}"}) for number in (1, 2, 3)
]
MET = Event(0.2, "matched", TOPIC, {"count": 1})


@pytest.mark.parametrize("said", [SAID, SAID[2:]])
def test_a_talker_that_spoke_for_a_while_did_not_publish_all_at_once_whatever_was_heard_of_it(
    said: list[Event],
) -> None:
    seen = [MET, _interface("publisher"), _message(2), *said, Event(1.6, "subject", "exited", {"code": 0})]
    evidence = Evidence([Part("talking", {}, seen)], TALKER)
    first = next(mistake.key for mistake in talker.EXERCISE.mistakes if mistake.recognize(evidence))
    assert first == "ended_too_early"


def test_a_talker_that_a_crowded_machine_held_up_in_its_first_moment_published_all_at_once() -> None:
    said = [replace(SAID[0], t=1.3 + 0.04 * number) for number in range(10)]
    seen = [Event(1.4, "matched", TOPIC, {"count": 1}), *said, Event(1.9, "subject", "exited", {"code": 0})]
    evidence = Evidence([Part("talking", {}, seen)], TALKER)
    first = next(mistake.key for mistake in talker.EXERCISE.mistakes if mistake.recognize(evidence))
    assert first == "published_before_discovery"


NODE_ONLY = Event(0.2, "interface", "graph", {"nodes": ["/node"]})
ANNOUNCED = Event(0.5, "announced", "a node")
READY = Event(0.3, "output", "stdout", {"text": "Ready."})


@pytest.mark.parametrize("said", [[], [READY]])
@pytest.mark.parametrize("seen", [[ANNOUNCED], [NODE_ONLY], [_interface("service")]])
def test_a_node_that_ends_at_once_is_told_the_same_whatever_the_graph_showed_of_it(
    seen: list[Event], said: list[Event]
) -> None:
    assert _told([*seen, *said]) == "ended_too_early"


@pytest.mark.parametrize(("said", "told"), [([], "main_guard"), ([READY], "nothing_on_the_graph")])
def test_a_program_that_ends_without_a_node_is_told_so(said: list[Event], told: str) -> None:
    assert _told(said) == told


@pytest.mark.parametrize(("waited", "certain"), [(12.3, True), (30.0, False)])
def test_only_on_a_calm_machine_a_program_that_goes_on_has_surely_no_node(
    waited: float, certain: bool
) -> None:
    survey = Event(waited, "interface", "graph", {"nodes": []})
    evidence = Evidence([Part("serving", {}, [READY, survey])], Reference("lab_1_3.server", {}))
    known = next(mistake for mistake in unfinished.NOTHING_THERE if mistake.recognize(evidence))
    assert (known.key, known.certain) == ("nothing_on_the_graph", certain)


def _told(seen: list[Event]) -> str:
    """What is told of a program that has come to its end."""
    ended = Event(0.4, "subject", "exited", {"code": 0})
    evidence = Evidence([Part("serving", {}, [*seen, ended])], Reference("lab_1_3.server", {}))
    return next(mistake.key for mistake in unfinished.NOTHING_THERE if mistake.recognize(evidence))


@pytest.mark.parametrize("heard", [[], [_message(1)]])
def test_a_deaf_talker_is_told_and_earns_the_same_whether_its_only_text_was_heard(heard: list[Event]) -> None:
    stack = 'Thread 0x1 (most recent call first):\n  File "/x/rclpy/executors.py", line 1 in spin\n'
    deaf = [Event(5.0, "unanswered", "/node"), Event(5.0, "stack", "subject", {"text": stack})]
    evidence = Evidence([Part("talking", {}, [_interface("publisher"), *heard, *deaf])], TALKER)
    assert _points(talker, evidence) == 3
    first = next(mistake.key for mistake in talker.EXERCISE.mistakes if mistake.recognize(evidence))
    assert first == "node_taken_from_executor"
    assert common.never_spun("publisher").recognize(evidence) is None


@pytest.mark.parametrize("seen", [[], [_interface("subscription")]])
def test_a_listener_that_dies_at_once_earns_the_same(seen: list[Event]) -> None:
    evidence_files = Reference("lab_1_2.listener", {"subscription": {TOPIC: TYPE}})
    late = Event(9.1, "sent", TOPIC, {"fields": {"data": "fjord 1234"}})
    part = Part("listening", {"texts": ["fjord 1234"]}, [*seen, *_printed(TRACEBACK), EXITED, late])
    assert _points(listener, Evidence([part], evidence_files)) == 0


@pytest.mark.parametrize(
    ("line", "is_made_of_it"), cases(__file__, "a_text_is_known_again_when_it_was_changed")
)
def test_a_text_is_known_again_when_it_was_changed(line: str, is_made_of_it: bool) -> None:
    assert has_much_of(line, "delta tundra 2548") is is_made_of_it


def test_a_traceback_is_nobody_s_words_wherever_an_event_falls_into_it() -> None:
    goal = Event(0.3, "goal", "/fibonacci", {"fields": {"order": 20}})
    lines = _printed(TRACEBACK)
    for place in range(len(lines) + 1):
        assert Part(LATE, {}, [*lines[:place], goal, *lines[place:]]).said(after=goal) == []


ANSWERED = Event(0.8, "goal_answered", "/fibonacci")


@pytest.mark.parametrize(
    ("events", "early"),
    [
        ([*_printed(TRACEBACK), ANSWERED, EXITED], True),
        ([EXITED, ANSWERED], True),
        ([ANSWERED, Event(1.5, "subject", "exited")], True),
        ([ANSWERED, Event(3.5, "subject", "exited")], True),
        pytest.param([ANSWERED, Event(5.4, "subject", "exited")], False, id="it spun for five seconds"),
        ([ANSWERED, *_printed(TRACEBACK, 1.0), Event(1.5, "subject", "exited")], False),
        ([ANSWERED, EXITED], False),
        ([ANSWERED], False),
        # Its last request arrives, or it is lost with its process.
        ([ANSWERED, Event(0.9, "result_request", ""), Event(1.5, "subject", "exited")], True),
        ([ANSWERED, Event(0.9, "result_request", ""), Event(2.9, "subject", "exited")], False),
        ([ANSWERED, Event(1.4, "result", ""), Event(1.5, "subject", "exited")], False),
    ],
)
def test_who_ends_at_once_has_not_shown_a_goal(events: list[Event], early: bool) -> None:
    goal = Event(0.3, "goal", "/fibonacci", {"fields": {"order": 20}})
    part = Part(LATE, {"order": 20}, [goal, *events])
    assert left_at_once(part) is early
    criteria = {c.name: c for c in action_client.EXERCISE.criteria}
    evidence = Evidence([part], Reference("lab_1_4.client", {"action_client": {}}, [part]))
    assert criteria["late"].judge(evidence).passed is not early


def test_who_says_something_of_the_answer_and_then_ends_never_asked_for_the_result() -> None:
    goal = Event(0.3, "goal", "/fibonacci", {"fields": {"order": 20}})
    said = Event(0.9, "output", "stdout", {"text": "Goal accepted"})
    part = Part(LATE, {"order": 20}, [goal, ANSWERED, said, Event(3.8, "subject", "exited")])
    evidence = Evidence([part], Reference("lab_1_4.client", {"action_client": {}}, [part]))
    assert ENDED_TOO_EARLY.recognize(evidence) is None
    assert RESULT_NOT_REQUESTED.recognize(evidence) is not None


@pytest.mark.parametrize("slow_to_end", [False, True])
def test_who_does_not_wait_for_an_answer_is_told_so_however_slowly_the_program_ends(
    slow_to_end: bool,
) -> None:
    asked = Event(0.4, "request", "/add_two_ints", {"fields": {"a": 2000, "b": 3000}})
    given = Event(0.4, "response", "/add_two_ints", {"fields": {"sum": -77_777}})
    quick = Part(BIASED, {}, [asked, given, Event(0.5, "output", "stdout", {"text": "sum: -77777"}), EXITED])
    gave_up = Event(0.5, "output", "stderr", {"text": "no answer"})
    late = [replace(given, t=0.9), EXITED] if slow_to_end else [EXITED, replace(given, t=9.5)]
    held = Part(EXTREME, {"numbers": [2000, 3000]}, [asked, gave_up, *late])
    evidence = Evidence([quick, held], evidence_files.load_reference("lab_1_3.client"))
    assert ANSWER_NOT_AWAITED.recognize(evidence)
    right = Part(EXTREME, {}, [asked, given, Event(0.5, "output", "stdout", {"text": "sum: -77777"}), EXITED])
    assert not ANSWER_NOT_AWAITED.recognize(replace(evidence, parts=[quick, right]))


def test_the_type_that_another_package_has_too_is_always_asked_for_in_the_same_run() -> None:
    """Otherwise a subject that takes the other package's type would lose other points from check to check."""
    asked: dict[str, set[str]] = {name: set() for name in (question.LATE, question.OTHER, question.ABSENT)}
    for name, robot in _questions():
        asked[name].add(robot.asked[0])
    twins = set(question.TWIN)
    assert asked[question.OTHER] == twins
    assert asked[question.LATE] == asked[question.ABSENT] == question.TEMPTING.keys() - twins


def test_one_that_names_another_service_has_not_looked_only_once() -> None:
    _, robot = next(drawn for drawn in _questions() if drawn[0] == question.LATE)
    other = next(name for name in robot.services if name != robot.answer["name"])
    named = [Event(0.2, "output", "stdout", {"text": other}), Event(0.4, "subject", "exited", {})]
    assert not Search(Part(question.LATE, vars(robot), named)).gave_up_at_once
    assert Search(Part(question.LATE, vars(robot), named[1:])).gave_up_at_once


@pytest.mark.parametrize("arrived", [(), CALLED, (CALLED[0], EXTREME)])
def test_a_client_that_stays_for_no_answer_gets_the_same_points_whether_its_requests_arrive(
    arrived: tuple[str, ...],
) -> None:
    reference = evidence_files.load_reference("lab_1_3.client")
    raised = Event(
        1.0, "subject", "raised", {"traceback": "AttributeError: no attribute 'add_done_callback'"}
    )
    runs = []
    for part in reference.parts:
        events: list[Event] = [
            Event(0.1, "serving", "/add_two_ints", {}),
            Event(0.9, "called", "a server", {}),
        ]
        if part.name in arrived:
            events.append(Event(0.95, "request", "/add_two_ints", {"fields": {"a": 1, "b": 2}}))
        runs.append(Part(part.name, {"numbers": [1, 2]}, [*events, raised]))
    criteria = service_client.EXERCISE.criteria
    met = [one.name for one in criteria if one.judge(Evidence(runs, reference)).passed]
    assert not {"call", "sum", "late"} & {*met}
