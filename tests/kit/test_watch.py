"""A watch is judged by the state that follows from its inputs and from time, which passes by itself."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from autograder.kit.evidence import Event, Evidence, Part, Reference
from autograder.kit.recipes.watch import SILENCE, Watch

if TYPE_CHECKING:
    from collections.abc import Sequence

    from autograder.kit.model import Exercise
    from autograder.kit.rules import Given

INTERFACE = {"publisher": {"/alarm": "x/msg/Y"}, "subscription": {"/beat": "x/msg/Y"}}
READY_MADE = ("too_early", "never_told", "told_too_often", "only_in_answer", "told_untruly", "told_too_late")
Said = tuple[float, str]


def watchdog() -> Exercise:
    """Lost a second after a beat. The beats come at 0, 0.5 and 2 s, and the run ends 1.6 s after the last one."""

    def state(beats: Sequence[Given], limit: float = 1.0) -> object:
        return "lost" if beats and beats[-1].age >= limit else "back"

    watch = Watch(
        "a.b", "A", "B", state=state, gives=[({}, 0.5), ({}, 1.5), ({}, 1.6)], within=0.2, waits=1.5
    )
    watch.says("lost", "lost", 4, "Says lost")
    watch.says("back", "back", 4, "Says back")
    watch.once("once", 2, "Once")
    watch.wrong("half", {"limit": 0.4}, "Half.", "Whole.")
    watch.wrong("first", lambda beats: state(beats) if beats else SILENCE, "At the first.", "Not so.")
    return watch.exercise()


def run(said: Sequence[Said], *, beats: int = 3, simulated: bool = True) -> Part:
    """Return a run in which this was said, each at a time."""
    given: list[tuple[float, str, dict[str, str]]] = [(at, "sent", {}) for at in (0.0, 0.5, 2.0)[:beats]]
    events = given + [(at, "message", {"data": text}) for at, text in said]
    return Part(
        "met",
        {},
        [
            Event(at + 2.0, kind, "/any", {"fields": fields}, at + 100 if simulated and at >= 0 else None)
            for at, kind, fields in sorted(events, key=lambda event: event[0])
        ],
    )


USUAL = [(1.55, "lost"), (2.0, "back"), (3.1, "lost")]


def judged(part: Part) -> tuple[set[str], str | None]:
    """Return the criteria that fail, and the first mistake of the exercise's own that is recognized."""
    exercise = watchdog()
    evidence = Evidence([part], Reference(exercise.id, INTERFACE, [run(USUAL)]))
    failed = {one.name for one in exercise.criteria if not one.judge(evidence).passed}
    own = (one for one in exercise.mistakes if one.key in (*READY_MADE, "half", "first"))
    return failed, next((one.key for one in own if one.recognize(evidence)), None)


@pytest.mark.parametrize(
    ("said", "failed", "told"),
    [
        (USUAL, set(), None),
        ([(1.5, "lost"), (2.05, "back"), (3.19, "lost")], set(), None),
        ([(1.5, "lost"), (1.9, "lost"), (2.0, "back"), (3.1, "lost")], {"once"}, "told_too_often"),
        ([(1.5, "lost"), (3.1, "lost")], {"back"}, "never_told"),
        ([(1.5, "Lost"), (2.0, "Back"), (3.1, "Lost")], {"lost", "back", "once"}, "never_told"),
        ([(2.0, "lost"), (2.0, "back")], {"lost"}, "only_in_answer"),
        ([(1.5, "lost"), (2.0, "back"), (3.5, "lost")], {"lost"}, "told_too_late"),
        ([(3.1, "lost")], {"lost", "back"}, "never_told"),
        ([(1.5, "lost"), (2.0, "back")], {"lost"}, "told_too_late"),
        ([(1.2, "lost"), (2.0, "back"), (3.0, "lost")], {"lost", "once"}, "told_untruly"),
        ([(-0.5, "lost"), *USUAL], {"once"}, "too_early"),
        ([(0.0, "back"), *USUAL], {"once"}, "first"),
        (
            [(0.4, "lost"), (0.5, "back"), (0.9, "lost"), (2.0, "back"), (2.4, "lost")],
            {"lost", "once"},
            "half",
        ),
        ([], {"lost", "back", "once"}, None),
    ],
)
def test_a_watch_says_each_change_once_and_in_time(
    said: Sequence[Said], failed: set[str], told: str | None
) -> None:
    assert judged(run(said)) == (failed, told)


def test_a_run_that_was_cut_short_fulfils_nothing() -> None:
    assert judged(run(USUAL[:1], beats=2))[0] == {"lost", "back", "once"}


def test_a_state_after_one_that_was_not_said_costs_nothing_more() -> None:
    assert judged(run([(3.1, "lost")]))[0] == {"lost", "back"}
    assert judged(run([(1.5, "lost")]))[0] == {"back"}


def test_in_real_time_a_busy_machine_may_hold_a_message_up() -> None:
    late = [(1.94, "lost"), (2.4, "back"), (3.4, "lost")]
    assert judged(run(late, simulated=False)) == (set(), None)
    assert judged(run(late))[0] == {"lost", "back"}


def test_a_state_that_ends_before_it_must_be_said_need_not_be_said() -> None:
    """The beat at 2 s comes, for a machine that held it up, when the heartbeat was lost for a tenth of a second."""
    watch = Watch(
        "a.b",
        "A",
        "B",
        state=lambda beats: "lost" if beats and beats[-1].age >= 1.4 else "back",
        gives=[({}, 0.5), ({}, 1.5), ({}, 1.6)],
        within=0.3,
    )
    watch.says("lost", "lost", 1, "Lost")
    (lost,) = watch.exercise().criteria
    evidence = Evidence([run([(3.5, "lost")])], Reference("a.b", INTERFACE, [run([(3.5, "lost")])]))
    assert lost.judge(evidence).passed


def watched(*seconds: float) -> Exercise:
    """Return a watchdog of one second with these silences."""
    watch = Watch(
        "a.b",
        "A",
        "B",
        state=lambda beats: "lost" if beats and beats[-1].age >= 1.0 else "back",
        gives=[({}, one) for one in seconds],
        within=0.3,
    )
    watch.says("lost", "lost", 1, "Lost")
    watch.once("once", 1, "Once")
    return watch.exercise()


def test_messages_with_which_a_wrong_node_would_pass_are_refused() -> None:
    watched(0.3, 1.65, 1.7, 0.97, 2.4)  # due at 1.3, 2.95 and 5.62 s
    watched(0.3, 1.2, 0.7)  # lost for too short a time to be reported
    with pytest.raises(
        ValueError, match=r"lost begins at 1\.3. s and lasts only 0\.4. s.*longer than 0\.55 s"
    ):
        watched(0.3, 1.4, 1.7, 0.97, 2.4)
    with pytest.raises(ValueError, match="checks the time only once a second"):
        watched(0.3, 2.0, 2.0, 1.0, 2.4)


def test_a_node_that_died_is_not_blamed_for_what_it_was_not_given() -> None:
    exercise = watchdog()
    usual = Reference(exercise.id, INTERFACE, [run(USUAL)])
    findings = {one.name: one.judge(Evidence([run([], beats=1)], usual)) for one in exercise.criteria}
    assert (findings["back"].expected, findings["back"].seen) == (
        "back, 1 time, at most 0.2 s late",
        "back, 0 times",
    )
    assert findings["once"].seen == "no message at all"
    longer = Part("met", {}, [*run(USUAL).events, Event(6.0, "sent", "/any", {"fields": {}}, 104.0)])
    (once,) = (one for one in exercise.criteria if one.name == "once")
    finding = once.judge(Evidence([run(USUAL)], Reference(exercise.id, INTERFACE, [longer])))
    assert (finding.passed, finding.seen) == (False, "the node ended before the last input")


def test_what_a_right_node_may_do_while_the_judge_moves_the_clock_is_looked_at_again() -> None:
    """A thread with a timer of its own may say the same twice if a heartbeat comes at the moment at which it fires."""
    certain = {one.key for one in watchdog().mistakes if one.key in READY_MADE and one.certain}
    assert certain == {"too_early"}


def test_a_node_may_log_its_states() -> None:
    watch = Watch(
        "a.b",
        "A",
        "B",
        state=lambda beats: "lost" if beats and beats[-1].age >= 1.0 else "back",
        gives=[({}, 0.5), ({}, 1.5), ({}, 1.6)],
        within=0.2,
        words=("lost", "back"),
    )
    watch.says("lost", "lost", 1, "Lost")
    watch.once("once", 1, "Once")
    exercise = watch.exercise()
    part = run([])
    lines = [Event(at + 2, "log", "/dog", {"text": f"{text}!"}, at + 100) for at, text in USUAL]
    part = Part("met", {}, sorted([*part.events, *lines], key=lambda event: event.t))
    for seen, points in ((part, 2), (run([]), 0), (run(USUAL), 0)):
        evidence = Evidence([seen], Reference("a.b", {"subscription": INTERFACE["subscription"]}, [run([])]))
        assert sum(one.judge(evidence).passed for one in exercise.criteria) == points


def test_the_ready_made_mistakes_are_explained_to_students() -> None:
    page = (Path(__file__).parents[2] / "docs/mistakes.md").read_text(encoding="utf-8")
    for key in READY_MADE:
        assert f"### `{key}`\n" in page
