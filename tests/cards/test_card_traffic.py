"""The moments that are shown: a fair share for each part, and a count of those that are not."""

from __future__ import annotations

from dataclasses import replace

from autograder.cards.card_traffic import MAX_LANES, OTHER_LANES, OWN_LANE, traffic
from autograder.verdict import Moment


def moments(
    count: int, part: str = "", lane: str = "/chatter", *, simulated: bool = False
) -> tuple[Moment, ...]:
    return tuple(Moment(t / 10, lane, "note", str(t), part, simulated) for t in range(count))


def test_groups_by_part_in_order_of_appearance() -> None:
    shown = traffic((*moments(2, "b"), *moments(2, "a")), at_most=60)
    assert [part.title for part in shown.parts] == ["b", "a"]
    assert shown.left_out == 0


def test_sorts_by_time_within_a_part() -> None:
    shown = traffic((Moment(2.0, "x", "note", "late"), Moment(1.0, "y", "note", "early")), at_most=60)
    assert [moment.label for moment in shown.parts[0].moments] == ["early", "late"]


def test_keeps_beginning_and_end_and_counts_the_rest() -> None:
    part = traffic(moments(300), at_most=60).parts[0]
    assert len(part.moments) == 60
    assert part.left_out == 240
    assert dict(part.gaps) == {39: 240}  # two thirds of what is shown are the beginning
    assert [part.moments[0].label, part.moments[-1].label] == ["0", "299"]
    assert int(part.moments[40].label) - int(part.moments[39].label) == 241


def test_never_leaves_out_what_the_story_hangs_on() -> None:
    long = list(moments(300))
    long[150] = replace(long[150], label="cancel request", key=True)
    part = traffic(long, at_most=60).parts[0]
    assert part.moments[40].label == "cancel request"
    assert dict(part.gaps) == {39: 110, 40: 129}
    assert len(part.moments) + part.left_out == 300


def test_a_lane_that_is_full_of_life_keeps_its_name() -> None:
    goals = [Moment(0.1 * n, f"/fibonacci, goal {n}", "to_subject", "goal") for n in range(12)]
    canceled = [Moment(2.0 + n, "/fibonacci, goal 11", "from_subject", "x") for n in range(3)]
    part = traffic([*goals, *canceled], at_most=60).parts[0]
    assert "/fibonacci, goal 11" in part.lanes
    assert part.lanes[-1] == OTHER_LANES


def test_that_a_program_has_ended_needs_no_picture() -> None:
    ended = Moment(1.0, OWN_LANE, "note", "exited")
    assert not traffic([ended], at_most=60).parts[0].is_worth_a_picture
    assert traffic([*moments(1), ended], at_most=60).parts[0].is_worth_a_picture


def test_names_on_the_graph_come_before_what_was_said_of_it() -> None:
    said = [Moment(float(n), lane, "note", "") for n, lane in enumerate((OWN_LANE, "log", "/chatter"))]
    assert traffic(said, at_most=60).parts[0].lanes == ("/chatter", "log", OWN_LANE)


def test_a_small_part_survives_beside_a_flood() -> None:
    shown = traffic((*moments(5000, "flood"), *moments(3, "small")), at_most=60)
    assert [len(part.moments) for part in shown.parts] == [59, 3]


def test_no_part_is_reduced_to_its_ends() -> None:
    shown = traffic((*moments(5000, "flood"), *moments(50, "small")), at_most=60)
    assert len(shown.parts[1].moments) == 4
    assert shown.parts[1].left_out == 46


def test_leaves_out_no_single_moment() -> None:
    assert traffic(moments(62), at_most=60).left_out == 0


def test_one_axis_has_one_kind_of_time() -> None:
    shown = traffic((*moments(2), *moments(2, simulated=True)), at_most=60)
    assert [part.simulated for part in shown.parts] == [False, True]
    assert shown.simulated


def test_many_names_share_the_last_lane() -> None:
    many = tuple(Moment(number, f"/t{number}", "note", "x") for number in range(30))
    part = traffic(many, at_most=60).parts[0]
    assert len(part.lanes) == MAX_LANES
    assert part.lanes[-1] == OTHER_LANES
    assert part.moments[-1].label == "/t29: x"


def test_many_parts_are_counted() -> None:
    shown = traffic([Moment(0.0, "x", "note", "y", f"part {number}") for number in range(40)], at_most=60)
    assert len(shown.parts) + shown.parts_left_out == 40
    assert shown.parts_left_out > 0
