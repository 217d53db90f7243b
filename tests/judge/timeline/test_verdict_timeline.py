"""What the card's timeline is told of the evidence."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from autograder.judge.timeline.verdict_timeline import MAX_MOMENTS, moments
from autograder.kit.evidence import Event, Evidence, Part, Reference
from autograder.kit.output import launched_processes, workspace_reports
from autograder.kit.output.workspace_reports import WorkspaceReport, workspace_report_line

if TYPE_CHECKING:
    from autograder.verdict import Moment


HELLO = {"data": "Hello, world! 0"}


def told(
    *events: Event, interface: dict[str, dict[str, str]] | None = None, **reference: Any
) -> list[Moment]:
    expected = Reference("an exercise", interface or {}, reference.get("parts", ()))
    return list(moments(Evidence([Part("", {}, events)], expected)))


def test_brackets_without_an_end_are_no_report() -> None:
    for mark in (launched_processes.PROCESS_MARK, workspace_reports.WORKSPACE_MARK):
        assert told(Event(0.1, "output", "stdout", {"text": f"{mark}{'[' * 3900}"})) is not None


def test_a_message_of_the_judges_own_is_told_once() -> None:
    sent = Event(0.1, "sent", "/status", {"fields": {"data": "status 16836"}})
    echo = Event(0.2, "message", "/status", {"fields": {"data": "status 16836"}})
    again = Event(0.3, "message", "/status", {"fields": {"data": "status 16836"}})
    assert [moment.direction for moment in told(sent, echo)] == ["to_subject"]
    # Who says it once more has said it.
    assert [moment.direction for moment in told(sent, echo, again)] == ["to_subject", "from_subject"]


def test_of_a_message_in_messages_the_numbers_that_are_not_zero_are_told() -> None:
    zeros = dict.fromkeys("xyz", 0.0)
    straight = Event(
        0.1, "message", "/cmd_vel", {"fields": {"linear": {**zeros, "x": 0.5}, "angular": zeros}}
    )
    still = Event(0.2, "message", "/cmd_vel", {"fields": {"linear": zeros}})
    assert [moment.label for moment in told(straight, still)] == ["linear.x=0.5", "all 0"]


def test_what_arrived_late_stands_where_it_was_sent() -> None:
    log = Event(0.10, "log", "talker", {"text": "Publishing", "sent": 1000.09, "arrived": 1000.10})
    message = Event(0.30, "message", "/chatter", {"fields": HELLO, "sent": 1000.08, "arrived": 1000.30})
    shown = told(log, message)
    assert [moment.lane for moment in shown] == ["/chatter", "log"]
    assert [moment.t for moment in shown] == [0.08, 0.09]


def test_a_time_of_sending_that_cannot_be_is_not_believed() -> None:
    forged = Event(0.5, "log", "talker", {"text": "x", "sent": 0.0, "arrived": 1000.0})
    later = Event(0.6, "log", "talker", {"text": "y", "sent": 2000.0, "arrived": 1000.0})
    assert [moment.t for moment in told(forged, later)] == [0.0, 0.6]


def test_a_program_that_was_built_first_begins_after_its_build() -> None:
    built = workspace_report_line(WorkspaceReport("built", built=True))
    shown = told(
        Event(20.5, "output", "stdout", {"text": built}),
        Event(21.7, "log", "simple_node", {"text": "Hello", "sent": 1000.0, "arrived": 1000.1}),
        Event(22.0, "subject", "exited", {"code": 0}),
    )
    assert [round(moment.t, 3) for moment in shown] == [1.1, 1.5]


def test_each_goal_has_a_lane_where_there_are_several() -> None:
    shown = told(
        Event(0.1, "goal_sent", "/fibonacci", {"goal": 0, "fields": {"order": 3}}),
        Event(0.2, "goal_sent", "/fibonacci", {"goal": 1, "fields": {"order": 5}}),
        Event(0.3, "cancel_sent", "/fibonacci", {"goal": 0}),
        Event(0.4, "result_heard", "/fibonacci", {"goal": 0, "status": 5, "fields": {"sequence": [0, 1]}}),
    )
    assert [moment.lane[-6:] for moment in shown] == ["goal 1", "goal 2", "goal 1", "goal 1"]
    assert shown[-1].label == "CANCELED [0, 1]"
    assert all(moment.key for moment in shown)


def test_goals_that_arrive_one_after_the_other_have_lanes_too() -> None:
    shown = told(
        Event(0.1, "goal", "/fibonacci", {"fields": {"order": 3}}),
        Event(0.2, "result", "/fibonacci", {"status": "succeeded", "fields": {"sequence": [0]}}),
        Event(0.3, "goal", "/fibonacci", {"fields": {"order": 4}}),
        Event(0.4, "cancel", "/fibonacci", {"accepted": True, "known": True}),
    )
    assert [moment.lane[-6:] for moment in shown] == ["goal 1", "goal 1", "goal 2", "goal 2"]


def test_a_single_goal_needs_no_number() -> None:
    assert [moment.lane for moment in told(Event(0.1, "goal", "/fibonacci", {"fields": {}}))] == [
        "/fibonacci"
    ]


def test_the_name_that_was_meant_and_the_wrong_one_are_both_told() -> None:
    survey = Event(0.4, "interface", "graph", {"publisher": {"/chater": "std_msgs/msg/String"}})
    shown = told(survey, survey, interface={"publisher": {"/chatter": "std_msgs/msg/String"}})
    assert [(moment.lane, moment.stray) for moment in shown] == [("/chater", True), ("/chatter", False)]
    assert [moment.label for moment in shown] == ["your publisher is here", "no publisher of yours"]


def test_topics_beside_the_right_one_are_nobodys_business() -> None:
    survey = Event(0.4, "interface", "graph", {"publisher": {"/chatter": "a", "/status": "b"}})
    assert told(survey, interface={"publisher": {"/chatter": "a"}}) == []


def test_a_cancel_request_is_told_after_any_flood() -> None:
    flood = [Event(n / 100, "feedback", "/fibonacci", {"fields": {"sequence": [n]}}) for n in range(500)]
    shown = told(*flood, Event(9.0, "cancel", "/fibonacci", {}))
    assert shown[-1].label == "cancel request"
    assert len(shown) == MAX_MOMENTS


def test_a_flood_of_goals_has_an_end() -> None:
    goals = [Event(n / 100, "goal", "/fibonacci", {"fields": {"order": 1}}) for n in range(5000)]
    assert len(told(*goals)) < 200


def test_the_first_text_that_nobody_expected_is_named() -> None:
    reference = (Part("", {}, (Event(0.1, "message", "/chatter", {"fields": HELLO}),)),)
    shown = told(
        Event(0.1, "message", "/chatter", {"fields": HELLO}),
        Event(0.2, "message", "/chatter", {"fields": {"data": "Hello world 1"}}),
        Event(0.3, "message", "/chatter", {"fields": {"data": "Hello world 2"}}),
        parts=reference,
    )
    assert [moment.key for moment in shown] == [False, True, False]


def test_that_a_program_got_going_needs_no_words() -> None:
    names = ("started", "constructed", "raised")
    shown = told(*(Event(n / 10, "subject", name, {}) for n, name in enumerate(names)))
    assert [moment.label for moment in shown] == ["raised"]


def ghosts(*seen: tuple[float, str, int], missed: bool = True) -> list[tuple[float, str]]:
    """The messages of a talker that are told as expected, where these were seen: when, the text, its number."""
    said = [
        Event(0.0, "message", "/chatter", {"fields": {"data": f"Hello, world! {n}"}}, n / 2)
        for n in range(10)
    ]
    reference = Reference("an exercise", {"publisher": {"/chatter": "t"}}, [Part("talking", {}, said)])
    came = [
        Event(t, "message", "/chatter", {"fields": {"data": text}, "number": number})
        for t, text, number in seen
    ]
    found = moments(Evidence([Part("talking", {}, came)], reference), missed=missed)
    return [(moment.t, moment.label) for moment in found if moment.direction == "expected"]


def test_messages_that_did_not_come_are_told_where_they_belong() -> None:
    right = [(0.7 + n / 2, f"Hello, world! {n}", n + 1) for n in range(10)]
    assert ghosts(*right) == []
    assert ghosts(*right[:8]) == [(4.7, "Hello, world! 8"), (5.2, "Hello, world! 9")]
    # One that nobody could hear yet is none that did not come.
    assert ghosts(*right[1:]) == []
    slow = [(0.7 + n, f"Hello, world! {n}", n + 1) for n in range(10)]
    assert ghosts(*slow)[:2] == [(1.2, "Hello, world! 1"), (1.7, "Hello, world! 2")]
    wrong = [(t, text.replace("!", "."), number) for t, text, number in right]
    assert ghosts(*wrong) == [(t, text) for t, text, _ in right[:5]]
    assert ghosts() == [(n / 2, f"Hello, world! {n}") for n in range(5)]
    assert ghosts(*wrong, missed=False) == [], "on a card with full marks nothing is missing"


def hellos(*said: tuple[float, int]) -> list[tuple[float, str, int]]:
    """Messages of a talker: when, and which number it tells."""
    return [(t, f"Hello, world! {told}", number) for number, (t, told) in enumerate(said, 1)]


def test_after_one_that_did_not_come_the_next_ones_are_not_missing_too() -> None:
    count = [0, 1, 2, 4, 5, 6, 7, 8, 9]
    skipped = [(n / 2, told) for n, told in enumerate(count)]
    assert ghosts(*hellos(*skipped)) == [(1.5, "Hello, world! 3")]
    lost = [(told / 2, told) for told in count]
    assert ghosts(*hellos(*lost)) == [(1.5, "Hello, world! 3")]
    stopped = [(n / 2 + (3 if n > 2 else 0), n) for n in range(10)]
    assert ghosts(*hellos(*stopped)) == [(1.5, "Hello, world! 3")]
    twice = [(n / 2, told) for n, told in enumerate([0, 1, 2, 2, 3, 4, 5, 6, 7, 8, 9])]
    assert ghosts(*hellos(*twice)) == []
    by_two = [(n / 2, 2 * n) for n in range(5)]
    assert [label[-1] for _, label in ghosts(*hellos(*by_two))] == ["1", "3", "5", "7", "9"]


def test_where_inputs_are_random_no_message_is_expected() -> None:
    said = [Event(0.0, "message", "/a", {"fields": HELLO}, n / 2) for n in range(4)]
    reference = Reference("an exercise", {}, [Part("talking", {"text": "one"}, said)])
    seen = Evidence([Part("talking", {"text": "two"}, ())], reference)
    assert moments(seen, missed=True) == ()


def watched(
    given: list[tuple[float, int]], said: list[tuple[float, bool]], *, simulated: bool = False
) -> Part:
    """A part in which these numbers were sent to the subject, and in which the subject said this, each at a time."""
    events = [(t, "sent", "/beat", number) for t, number in given]
    events += [(t, "message", "/alarm", alarm) for t, alarm in said]
    return Part(
        "met",
        {},
        [
            Event(t, kind, name, {"fields": {"data": data}}, t if simulated else None)
            for t, kind, name, data in sorted(events)
        ],
    )


def demanded(part: Part) -> list[tuple[float, str]]:
    """The messages that the card demands of a subject, if the solution was sent 1 to 3 and said when all is lost."""
    usual = watched([(0, 1), (2, 2), (4, 3)], [(1.0, True), (2.1, False), (3.0, True)], simulated=True)
    found = moments(Evidence([part], Reference("an exercise", {}, [usual])), missed=True)
    return [(moment.t, moment.label) for moment in found if moment.direction == "expected"]


def test_a_message_is_due_as_long_after_its_input_as_the_solution_took() -> None:
    # In real time the inputs come at other times. The message before the first is too early, and moves no other.
    given = [(3.0, 1), (5.4, 2), (7.9, 3)]
    right = [(4.1, True), (5.5, False), (6.5, True)]
    assert demanded(watched(given, right)) == []
    assert demanded(watched(given, [(2.9, False), *right])) == []
    assert demanded(watched(given, right[::2])) == [(5.5, "False")]
    assert demanded(watched(given[:1], [])) == [(4.0, "True")]


def test_where_other_numbers_were_drawn_no_message_is_expected() -> None:
    assert demanded(watched([(3.0, 1), (5.0, 7), (7.0, 3)], [])) == []
