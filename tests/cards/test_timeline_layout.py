"""The picture's geometry: nothing overlaps, nothing leaves the picture, order is kept."""

from __future__ import annotations

import random
from itertools import pairwise

import pytest

from autograder.cards import readable_text
from autograder.cards.card_traffic import TrafficPart, traffic
from autograder.cards.timeline_layout import HALF_WIDTH, TURNS, WIDTH, Lane, Mark, Picture, picture
from autograder.verdict import Moment, Verdict

CHARACTER = 6.62  # pixels of a character of the 11-pixel label font (DejaVu Sans Mono and Menlo: 0.602 em)


def parts_of(verdict: Verdict) -> tuple[TrafficPart, ...]:
    return traffic(verdict.timeline, at_most=60).parts


def texts(lane: Lane, width: int) -> list[tuple[float, float, float, float]]:
    """Left, right, top and bottom of each label, and of the lane's name, in pixels."""
    boxes = [(0.0, readable_text.width(lane.name) * 7.3, lane.name_y - 9, lane.name_y + 2)]
    for mark in lane.marks:
        if mark.label:
            length = readable_text.width(mark.label) * CHARACTER
            x = mark.x * width / 100 + 4
            boxes.append((x, x + length, mark.label_y - 9, mark.label_y + 2))
    return boxes


def assert_legible(drawn: Picture, width: int) -> None:
    top = 0.0
    for lane in drawn.lanes:
        boxes = texts(lane, width)
        for index, (left, right, upper, lower) in enumerate(boxes):
            assert left >= 0
            assert right <= width
            assert upper >= top
            assert lower <= lane.line_y
            for other_left, other_right, other_upper, other_lower in boxes[index + 1 :]:
                apart = right <= other_left or other_right <= left
                assert apart or lower <= other_upper or other_lower <= upper
        for mark in lane.marks:
            if mark.label:
                x = mark.x * width / 100
                for left, right, upper, _ in boxes:
                    crosses = left < x < right and mark.label_y < upper
                    assert not crosses, f"the leader of {mark.label!r} runs through another label"
        top = lane.line_y
    assert drawn.axis_y >= top
    assert drawn.height > drawn.axis_y


@pytest.mark.parametrize("width", [WIDTH, HALF_WIDTH])
def test_samples_are_legible(verdict: Verdict, width: int) -> None:
    for part in parts_of(verdict):
        assert_legible(picture(part, width), width)


def test_any_traffic_is_legible() -> None:
    for seed in range(60):
        chance = random.Random(seed)
        scale = chance.choice([0.001, 0.1, 1.0, 30.0])
        moments = tuple(
            Moment(
                t=chance.choice([0.0, 5.0]) * scale + chance.random() * scale,
                lane=chance.choice(["/chatter", "add_two_ints", "log", "fibonacci/_action/feedback"]),
                direction=chance.choice(["from_subject", "to_subject", "note"]),
                label=chance.choice(
                    ["sum = 3", "Hello, world! 12", "service not available, waiting again...", ""]
                ),
            )
            for _ in range(chance.randint(1, 60))
        )
        for part in traffic(moments, at_most=60).parts:
            assert_legible(picture(part, WIDTH), WIDTH)


def marks_of(part: TrafficPart, width: int = WIDTH) -> list[Mark]:
    """The marks in the order of the part's moments."""
    drawn = picture(part, width)
    in_lane = {name: iter(lane.marks) for name, lane in zip(part.lanes, drawn.lanes, strict=True)}
    return [next(in_lane[moment.lane]) for moment in part.moments]


def test_keeps_the_order_across_lanes(verdict: Verdict) -> None:
    for part in parts_of(verdict):
        xs = [mark.x for mark in marks_of(part)]
        assert xs == sorted(xs)
        assert 0 <= xs[0] <= xs[-1] <= 100


@pytest.mark.parametrize("width", [WIDTH, HALF_WIDTH])
def test_the_x_of_a_mark_is_the_x_of_its_time(verdict: Verdict, width: int) -> None:
    for part in parts_of(verdict):
        if part.stands_still:
            continue
        first, last = part.moments[0].t, part.moments[-1].t
        xs = [mark.x for mark in marks_of(part, width)]
        for moment, x in zip(part.moments, xs, strict=True):
            share = (moment.t - first) / (last - first)
            assert x == pytest.approx(xs[0] + share * (xs[-1] - xs[0]), abs=0.02)


def test_moments_of_one_time_stand_at_one_x_and_hide_each_other_not() -> None:
    moments = (
        Moment(0.0, "/chatter", "from_subject", "Hello, world! 0"),
        Moment(0.0, "log", "from_subject", "Publishing"),
        Moment(1.0, "/add", "to_subject", "a=1"),
        Moment(1.0, "/add", "from_subject", "sum=1"),
    )
    one, two, three, four = marks_of(TrafficPart("", False, moments))
    assert one.x == two.x
    assert three.x == four.x
    assert four.y - three.y >= 11


def test_time_that_stands_still_has_an_order_and_no_seconds() -> None:
    moments = tuple(Moment(0.0, "/chatter", "to_subject", f"text {n}", "", True) for n in range(6))
    part = TrafficPart("", True, moments)
    drawn = picture(part)
    xs = [mark.x for mark in drawn.lanes[0].marks]
    assert all(left < right for left, right in pairwise(xs))
    assert [tick.text for tick in drawn.ticks] == [TURNS]
    assert not any(" s" in mark.tooltip.split(" on ")[0] for mark in drawn.lanes[0].marks)
    assert drawn.lanes[0].marks[2].tooltip.startswith("no. 3 on /chatter")


def test_what_the_story_hangs_on_is_always_labelled() -> None:
    for seed in range(40):
        chance = random.Random(seed)
        moments = tuple(
            sorted(
                (
                    Moment(
                        t=chance.choice([0.0, 1.0, chance.random() * 3]),
                        lane=chance.choice(["/fibonacci", "log"]),
                        direction="from_subject",
                        label=(
                            words := chance.choice(["goal 20", "cancel request", "CANCELED [0, 1, 1]", "…"])
                        ),
                        key=words != "…",
                    )
                    for _ in range(chance.randint(2, 50))
                ),
                key=lambda moment: moment.t,
            )
        )
        for part in traffic(moments, at_most=20).parts:
            assert_legible(picture(part, HALF_WIDTH), HALF_WIDTH)
            for moment, mark in zip(part.moments, marks_of(part, HALF_WIDTH), strict=True):
                assert mark.label == moment.label or not moment.key


def test_draws_an_uncrowded_axis_true_to_time() -> None:
    moments = tuple(Moment(float(second), "/chatter", "note", "") for second in range(9))
    xs = [mark.x for mark in picture(TrafficPart("", False, moments)).lanes[0].marks]
    steps = [right - left for left, right in pairwise(xs)]
    assert max(steps) - min(steps) < 0.05


def test_ticks_stand_at_their_times() -> None:
    moments = (Moment(0.0, "a", "note", "x"), Moment(4.0, "a", "note", "y"))
    drawn = picture(TrafficPart("", False, moments))
    by_text = {tick.text: tick.x for tick in drawn.ticks}
    assert by_text["0 s"] == drawn.lanes[0].marks[0].x
    assert by_text["4 s"] == drawn.lanes[0].marks[1].x


def test_milliseconds_are_written_as_such() -> None:
    moments = (Moment(0.214, "a", "note", "x"), Moment(0.219, "a", "note", "y"))
    assert "216 ms" in {tick.text for tick in picture(TrafficPart("", False, moments)).ticks}


def test_a_single_moment_and_equal_moments_can_be_drawn() -> None:
    for t in (0.0, 5.0, -3.0):
        for count in (1, 3):
            assert_legible(picture(TrafficPart("", False, (Moment(t, "a", "note", "x"),) * count)), WIDTH)


def test_repeated_words_are_written_once_in_a_full_lane() -> None:
    moments = tuple(Moment(t / 2, "/chatter", "from_subject", f"Hello, world! {t}") for t in range(8))
    labels = [mark.label for mark in picture(TrafficPart("", False, moments)).lanes[0].marks]
    assert labels == ["Hello, world! 0", *(f"…{number}" for number in range(1, 8))]


def test_the_same_label_again_is_not_repeated() -> None:
    moments = tuple(Moment(float(t), "log", "from_subject", "waiting again...") for t in range(7))
    labels = [mark.label for mark in picture(TrafficPart("", False, moments)).lanes[0].marks]
    assert labels == ["waiting again...", *[""] * 6]
