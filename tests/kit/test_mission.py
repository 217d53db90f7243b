"""A mission's world is stepped with the subject's answers, and its lines are judged from what the world noted."""

from __future__ import annotations

import math
from contextlib import suppress
from dataclasses import replace
from itertools import pairwise
from random import Random
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

import pytest

from autograder.judge.evidence_files import dump_reference
from autograder.kit.bench import Pace
from autograder.kit.evidence import Event, Evidence, Part, Reference
from autograder.kit.mission.course import NOTHING_REACHED
from autograder.kit.mission.mission import Goal, Mission, Moment, Pose, To, Wall, Walls, World
from autograder.kit.mission.track import ways
from autograder.kit.output.launched_processes import Process, process_line
from tests.cases import cases

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from autograder.kit.model import Exercise

TWIST, ODOMETRY, LASER = "geometry_msgs/msg/Twist", "nav_msgs/msg/Odometry", "sensor_msgs/msg/LaserScan"
BRAKE = {"publisher": {"/cmd_vel": TWIST}, "subscription": {"/scan": LASER, "/odom": ODOMETRY}}
IN_THE_WAY = World(Walls([Wall((3.0, -1.0), (3.0, 1.0))]), Pose(0.0, 0.0, 0.0))


class Confirmed(Exception):
    """The look in real time goes as the first one went."""


class Ros:
    """A bench without ROS, for a subject that is a function of what it has heard. It answers at once."""

    def __init__(
        self, answer: Callable[[Ros], object], interface: Mapping[str, Mapping[str, str]], **more: Any
    ):
        self.pace, self.random = Pace.FAST, Random("seed")
        self.reference = Reference("a.b", interface, more.get("recorded", ()))
        self.moment, self.heard, self.before = 100.0, dict[str, Any](), more.get("before")
        self._answer, self._hangs_at = answer, more.get("hangs_at", 1e9)
        self.events: list[Event] = []
        self.asked_whether_it_spins = False
        self.answers = dict[str, Any]()
        self.record("interface", "graph", **interface, nodes=["/driver"])

    def record(self, kind: str, name: str, **data: Any) -> None:
        self.events.append(Event(self.moment, kind, name, data, self.moment))

    def command(self, speed: float, turn: float = 0.0) -> None:
        """Publish a command, as the subject."""
        self.record("message", "/cmd_vel", fields={"linear": {"x": speed}, "angular": {"z": turn}})

    def run_time(self, seconds: float, **_: Any) -> bool:
        """Let the subject answer, unless it hangs."""
        self.moment = round(self.moment + seconds, 6)
        if self.moment - 100.0 > self._hangs_at:
            return False
        self._answer(self)
        return True

    def seen(self) -> Part:
        return Part("mission", {}, tuple(self.events))

    def speak(self, topic: str, _: str) -> Any:
        def send(**fields: Any) -> None:
            self.heard[topic] = fields
            self.record("sent", topic, fields=fields)

        return SimpleNamespace(send=send)

    def part(self, _: str, **inputs: Any) -> None:
        self.inputs = inputs

    def note(self, name: str, **data: Any) -> None:
        self.record("noted", name, **data)

    def serve(self, service: str, _: str, answer: Any, **__: Any) -> None:
        self.answers[service] = answer

    def serve_action(self, action: str, _: str) -> Any:
        def send(distance: float) -> None:
            self.record("feedback", action, fields={"distance": distance})

        return SimpleNamespace(await_goal=lambda _: None, send_feedback=send)

    def confirm(self) -> None:
        raise Confirmed

    def note_whether_it_spins(self) -> None:
        self.asked_whether_it_spins = True

    def await_endpoint(self, _: str, __: str) -> bool:
        return True

    def __getattr__(self, name: str) -> Any:
        return lambda *_, **__: None


def mission(**more: Any) -> Exercise:
    """Stand in front of a wall, and do not touch it."""
    how = {
        "world": IN_THE_WAY,
        "reaches": [
            ("Stands in front of the wall", lambda now: now.ahead < 1.0 and now.stood > 1.0, "stands", 6)
        ],
        "never": [("Touches no wall", lambda now: now.bumped)],
        "roles": ("publisher", "subscription"),
    }
    return Mission("a.b", "A", "B", **{**how, **more}).exercise()


def driven(exercise: Exercise, answer: Callable[[Ros], object], **more: Any) -> tuple[dict[str, bool], Ros]:
    """Return which lines hold after the mission of a subject, and its bench."""
    bench = Ros(answer, more.pop("interface", BRAKE), **more)
    exercise.scenario(bench)  # type: ignore[arg-type]
    evidence = Evidence([bench.seen()], bench.reference)
    return {one.name: one.judge(evidence).passed for one in exercise.criteria}, bench


def noted(bench: Ros, line: str) -> str:
    """Return what the mission noted about a line."""
    return next(event.data["text"] for event in bench.events if (event.kind, event.name) == ("noted", line))


def brakes(at: float) -> Callable[[Ros], None]:
    """Drive on until the laser sees a wall at a distance."""
    return lambda ros: ros.command(
        0.5 if ros.heard.get("/scan", {"ranges": [9.0]})["ranges"][0] > at else 0.0
    )


def test_a_robot_that_stops_in_front_of_the_wall_gets_all_points() -> None:
    holds, bench = driven(mission(), brakes(0.9))
    assert holds == {"stands": True, "touches_no_wall": True}
    assert not bench.asked_whether_it_spins
    assert "at x = 2." in noted(bench, "end")


@pytest.mark.parametrize(
    ("answer", "lines"),
    [
        (lambda ros: ros.command(0.5), {"stands": False, "touches_no_wall": False}),
        (brakes(1.5), {"stands": False, "touches_no_wall": False}),
        (lambda ros: None, {"stands": False, "touches_no_wall": False}),
    ],
)
def test_a_wall_that_is_hit_or_never_reached_costs_its_points(
    answer: Callable[[Ros], None], lines: dict[str, bool]
) -> None:
    holds, bench = driven(mission(), answer)
    assert holds == lines
    assert bench.asked_whether_it_spins


def test_a_robot_that_breaks_no_rule_because_it_does_nothing_gets_nothing_for_it() -> None:
    holds, bench = driven(mission(), lambda ros: None)
    assert not holds["touches_no_wall"]
    assert noted(bench, "touches_no_wall") == NOTHING_REACHED


def test_only_a_mission_about_the_commands_compares_them_with_the_recorded_ones() -> None:
    def inputs(**more: Any) -> list[Mapping[str, Any]]:
        recorded = ((), (Part("mission"),))
        return [driven(mission(**more), brakes(0.9), recorded=parts)[1].inputs for parts in recorded]

    assert inputs(drives=("Drives ahead",)) == [{}, {}]
    assert inputs() == [{}, {"goes": "its own way"}]


def test_the_programs_of_a_launch_have_met_before_their_time_passes() -> None:
    """They are on the graph before they have discovered each other, and a call that is answered late would be over."""
    waited: list[bool] = []

    class Launched(Ros):
        def wait_until(self, met: Callable[[Evidence], bool], *_: Any) -> bool:
            for come in (False, True):
                if come:
                    self.command(0.0)
                waited.append(met(Evidence([self.seen()], self.reference)))
            assert self.moment == 100.0
            return True

    bench = Launched(brakes(0.8), BRAKE)
    mission().scenario(bench)  # type: ignore[arg-type]
    assert not waited  # one program is all of the subject
    bench = Launched(brakes(0.8), BRAKE)
    bench.record("output", "stdout", text=process_line(Process(1, 0, ("act",))))
    mission().scenario(bench)  # type: ignore[arg-type]
    assert waited == [False, True]


def test_a_subject_that_hangs_ends_the_mission_and_keeps_what_it_has_reached() -> None:
    holds, bench = driven(mission(), brakes(0.9), hangs_at=2.0)
    assert bench.moment < 102.5
    assert bench.asked_whether_it_spins
    assert not any(holds.values())


def test_a_command_holds_for_a_second() -> None:
    def once(ros: Ros) -> None:
        if not ros.seen().of("message"):
            ros.command(0.5)

    _, bench = driven(mission(), once)
    assert "at x = 0.50 m" in noted(bench, "end")


def test_a_walk_that_pushes_against_a_wall_is_over_once_the_subject_is_silent() -> None:
    ends = {"action_client": {"/walk_to": "small_robot_interfaces/action/WalkTo"}}

    def sends_it_through_the_wall(ros: Ros) -> None:
        if ros.moment > 101.0 and not ros.seen().of("goal"):
            ros.record("goal", "/walk_to", fields={"x": 5.0, "y": 0.0})

    holds, bench = driven(mission(quiet=2.0), sends_it_through_the_wall, interface=ends)
    assert not any(holds.values())
    assert "at x = 2.80 m" in noted(bench, "end")
    # It sets out after a second, is at the wall after some seconds more, and the world goes on for a second at the end.
    assert 108.0 < bench.moment < 112.0


def test_the_same_commands_lead_to_the_same_places_with_the_same_seed() -> None:
    def draws(random: Random) -> Sequence[Any]:
        return [replace(IN_THE_WAY, start=Pose(random.uniform(0.0, 1.0), 0.0, 0.0)), 1.0]

    runs = [driven(mission(draws=draws), brakes(0.9))[1].events for _ in range(2)]
    assert runs[0] == runs[1]
    assert runs[0] != driven(mission(), brakes(0.9))[1].events


def test_a_second_world_puts_the_robot_at_its_start_and_a_step_gives_an_input() -> None:
    legs: dict[int, tuple[float, bool]] = {}

    def far(now: Moment) -> bool:
        legs[now.leg] = now.pose.y, now.stood > 0.4
        return now.leg == 1

    steps = [IN_THE_WAY, 0.5, replace(IN_THE_WAY, start=Pose(1.0, 0.5, 0.0)), To("/odom", {}), 0.3]
    driven(mission(draws=lambda _: steps, reaches=[("Far", far)]), lambda ros: None)
    assert legs == {0: (0.0, True), 1: (0.5, False)}, "there it has stood since it came"


def test_a_step_that_the_solution_does_not_take_is_named() -> None:
    with pytest.raises(ValueError, match=r"neither subscribes to '/nothing' nor serves it"):
        driven(mission(draws=lambda _: [To("/nothing", 1)]), lambda ros: None)
    with pytest.raises(ValueError, match=r"no action '/dock'"):
        driven(mission(draws=lambda _: [Goal("/dock", {})]), lambda ros: None)


def moment(*events: tuple[str, str, Mapping[str, Any]]) -> Moment:
    """Return a moment after these events, one a second."""
    part = Part("mission", {}, [Event(at, kind, name, data) for at, (kind, name, data) in enumerate(events)])
    return Moment(part, "/cmd_vel")


def test_a_command_right_behind_a_call_counts_as_earlier() -> None:
    now = moment(
        ("message", "/cmd_vel", {"fields": {}, "number": 2}), ("request", "/lamp", {"fields": {"data": True}})
    )
    late = Event(1.2, "message", "/cmd_vel", {"fields": {}, "number": 3})
    later = replace(late, t=1.4, data={"fields": {}, "number": 4})
    now = replace(now, part=replace(now.part, events=[*now.part.events, late, later]))
    assert now.commands == 4
    assert now.asked("/lamp") == "1 call (True) after 3 commands"


def test_a_goal_before_the_answer_is_told() -> None:
    fields: dict[str, Any] = {"fields": {"x": 4.0}}
    call, goal, answer = (
        ("request", "/lamp", fields),
        ("goal", "/walk_to", fields),
        ("response", "/lamp", fields),
    )
    assert moment(call, goal, answer).sent("/walk_to") == "1 goal: x = 4, before the answer"
    assert moment(call, answer, goal, goal).sent("/walk_to") == "2 goals: x = 4"
    assert moment().sent("/walk_to") == "no goal"


def test_what_became_of_a_goal_is_read_from_the_answers() -> None:
    now = moment(
        ("goal_sent", "/dock", {"goal": 0, "fields": {"x": 1.0}}),
        ("goal_answer", "/dock", {"goal": 0, "accepted": True}),
        ("feedback_heard", "/dock", {"goal": 0, "fields": {"distance": 0.5}}),
        ("cancel_answer", "/dock", {"goal": 0, "accepted": True}),
        ("result_heard", "/dock", {"goal": 0, "status": 5, "fields": {"arrived": False}}),
    )
    run = now.goal(0)
    assert (run.accepted, run.cancel_accepted, now.ended(), len(run.feedback)) == (True, True, "CANCELED", 1)
    assert not now.goal(1).over


def test_a_sensor_is_silent_for_some_time_after_a_line_was_reached() -> None:
    out = ("Sets out", lambda now: now.pose.x > 0.2)
    silent: list[float] = []

    def senses(now: Moment) -> Mapping[str, Any] | None:
        return {} if now.since("Sets out") < 1.0 else None

    def counts(ros: Ros) -> None:
        ros.command(0.5)
        sent = [event.moment for event in ros.events if (event.kind, event.name) == ("sent", "/odom")]
        silent[:] = [b - a for a, b in pairwise(sent)]

    driven(mission(reaches=[out], senses={"/odom": senses}, until=lambda now: now.time > 2.0), counts)
    assert 1.0 <= max(silent) < 1.3
    assert sorted(silent)[-2] < 0.15


def test_a_service_of_the_world_answers_what_its_author_says() -> None:
    places = {"lamp": (3.0, 1.0)}
    ends = {**BRAKE, "client": {"/where": "std_srvs/srv/Trigger", "/light": "std_srvs/srv/SetBool"}}
    serves = {"/where": lambda now: {"message": str(now.to("lamp"))}}
    _, bench = driven(
        mission(world=replace(IN_THE_WAY, places=places), serves=serves), brakes(0.9), interface=ends
    )
    assert float(bench.answers["/where"]({})["message"]) == pytest.approx(1.25, abs=0.2)
    assert bench.answers["/light"]({"data": True})["message"] == "the lamp is on"


DRIVER = {"publisher": {"/cmd_vel": TWIST}}


def driver(**more: Any) -> Exercise:
    """Drive ahead, twice a second."""
    how = {"drives": ("Drives", "velocity", 6), "rate": ("Keeps on", "rate", 4), "within": 9.0}
    return Mission("a.b", "A", "B", **{**how, **more}).exercise()


def every(period: float, most: int = 1000, speed: float = 0.5) -> Callable[[Ros], None]:
    """Publish a command in each period, at most so many."""

    def answer(ros: Ros) -> None:
        came = len(ros.seen().of("message"))
        if came < most and ros.moment - 100.0 >= period * came - 1e-9:
            ros.command(speed)

    return answer


def judged(answer: Callable[[Ros], object], solution: Callable[[Ros], object]) -> tuple[dict[str, bool], str]:
    """Return which lines hold, and the first mistake that is recognized."""
    recorded = [driven(driver(), solution, interface=DRIVER)[1].seen()]
    holds, bench = driven(driver(), answer, interface=DRIVER, recorded=recorded)
    evidence = Evidence([bench.seen()], bench.reference)
    keys = (one.key for one in driver().mistakes if one.recognize(evidence))
    return holds, next(keys, "")


@pytest.mark.parametrize(
    ("answer", "velocity", "rate", "key"),
    [
        (every(0.5), True, True, ""),
        (every(0.5, speed=0.5004), True, True, ""),
        (every(0.5, speed=0.4), False, True, "wrong_movement"),
        (every(2.0), True, False, "wrong_rate"),
        (every(0.5, most=12), True, False, "stopped_publishing"),
        (lambda ros: None, False, False, "never_published"),
    ],
)
def test_commands_are_the_solutions_keep_its_rate_and_go_on(
    answer: Callable[[Ros], None], velocity: bool, rate: bool, key: str
) -> None:
    assert judged(answer, every(0.5)) == ({"velocity": velocity, "rate": rate}, key)


def test_if_the_solutions_commands_come_to_an_end_their_number_counts() -> None:
    assert judged(every(0.5, most=5), every(0.5, most=6))[0]["velocity"] is False
    assert judged(every(0.5, most=6), every(0.5, most=6))[0]["velocity"] is True


def test_a_step_may_wait_for_a_moment() -> None:
    def draws(_: Random) -> Sequence[Any]:
        return [IN_THE_WAY, lambda now: now.pose.x > 1.0, To("/follow", True)]

    interface = {**BRAKE, "subscription": {**BRAKE["subscription"], "/follow": "std_msgs/msg/Bool"}}
    given: list[float] = []

    def answer(ros: Ros) -> None:
        if "/follow" in ros.heard and not given:
            given.append(ros.heard["/odom"]["pose"]["pose"]["position"]["x"])
        brakes(0.9)(ros)

    holds, _ = driven(mission(draws=draws), answer, interface=interface)
    assert holds["stands"]
    assert given == [pytest.approx(1.0, abs=0.1)]


def test_the_way_through_each_world_in_which_the_robot_drove_is_kept() -> None:
    lamp = World(Walls([Wall((3.0, -1.0), (3.0, 1.0))]), Pose(1.0, 0.5, 0.0), {"lamp": (2.0, 0.5)})
    still = World(start=Pose(5.0, 3.0, 0.0))
    exercise = mission(draws=lambda _: [IN_THE_WAY, 1.0, lamp, 4.0, still, 2.0], reaches=(), within=8.0)
    _, bench = driven(exercise, lambda ros: ros.command(0.5 if ros.moment < 105.0 else 0.0))
    first, second = ways(Evidence([bench.seen()], bench.reference))
    assert (first.points[0], first.places, first.bumps) == ((0.0, 0.0), {}, ())
    assert first.length == pytest.approx(0.5, abs=0.1)
    assert second.points[0] == (1.0, 0.5)
    assert (second.walls, second.places) == ((((3.0, -1.0), (3.0, 1.0)),), {"lamp": (2.0, 0.5)})
    assert second.bumps == (second.points[-1],)
    assert all(math.dist(*pair) >= 0.05 for pair in pairwise(second.points[:-1]))


def test_the_way_is_no_part_of_a_recording() -> None:
    _, bench = driven(mission(), brakes(0.9))
    assert "ways" not in dump_reference(Reference("a.b", BRAKE, [bench.seen()]), ["noted"])


def follows(*way: tuple[int, float, float]) -> Callable[[Ros], None]:
    """Return a subject that goes by a counter: so many commands with a speed and a turn, and so on; then it stands."""
    commands = [(speed, turn) for count, speed, turn in way for _ in range(count)]

    def drive(ros: Ros) -> None:
        ros.command(*(commands.pop(0) if commands else (0.0, 0.0)))

    return drive


AHEAD, BACK, CIRCLE = (80, 0.5, 0.0), (20, 0.0, 1.0), (999, 0.5, 1.0)
THERE = {
    "world": World(),
    "reaches": [("Comes far", lambda now: now.pose.x > 99)],
    "never": (),
    "within": 60.0,
}


def ends_at(answer: Callable[[Ros], object], **more: Any) -> float:
    """Return at which second a mission ends, in a look that confirms the first one or goes to its own end."""
    bench = Ros(answer, BRAKE, **more)
    with suppress(Confirmed):
        mission(**THERE).scenario(bench)  # type: ignore[arg-type]
    return bench.moment - 100.0


def first_look(answer: Callable[[Ros], object]) -> Evidence:
    bench = Ros(answer, BRAKE)
    mission(**THERE).scenario(bench)  # type: ignore[arg-type]
    return Evidence([bench.seen()], bench.reference)


@pytest.mark.parametrize(("way", "ends"), cases(__file__, "a_look_that_goes_as_the_first_one_ends"))
def test_a_look_that_goes_as_the_first_one_ends(way: list[Any], ends: float) -> None:
    assert ends_at(follows(*way), before=first_look(follows(*way))) == pytest.approx(ends, abs=0.5)


@pytest.mark.parametrize(
    "way", [[AHEAD, BACK, AHEAD], [AHEAD, (999, 0.0, 0.0)], [(999, 0.0, 0.0)], [(40, 0.5, 0.0), BACK, AHEAD]]
)
def test_a_look_that_goes_another_way_than_the_first_one_goes_to_its_end(way: list[Any]) -> None:
    """Such as that of a node which goes by the computer's clock, and did not get on in simulated time."""
    before = first_look(follows((999, 0.5, 0.0)))
    assert ends_at(follows(*way), before=before) == ends_at(follows(*way))


def test_the_same_commands_at_other_times_confirm_nothing() -> None:
    slow, quick = [(120, 0.1, 0.0), BACK, AHEAD], [(60, 0.1, 0.0), BACK, AHEAD]
    assert ends_at(follows(*quick), before=first_look(follows(*slow))) == ends_at(follows(*quick))


def test_a_robot_that_stands_goes_on_as_long_as_it_says_something_new() -> None:
    said = iter(range(100_000))
    speaks = lambda ros: ros.record("message", "/cmd_vel", fields={"linear": {"z": next(said)}})  # noqa: E731
    assert ends_at(speaks) > 20.0


def test_a_robot_that_circles_under_one_command_ends_its_mission_soon() -> None:
    assert ends_at(follows(CIRCLE)) < 10.0
    assert ends_at(follows((30, 0.2, 1.0), (999, 0.0, -0.1))) > 20.0


def test_a_robot_that_stands_and_repeats_its_command_ends_its_mission_soon() -> None:
    assert ends_at(follows((10, 0.5, 0.0))) < 10.0
