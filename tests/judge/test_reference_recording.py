"""A recording is a look in which nothing was blurred: what a busy machine has blurred is looked at again."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any, cast

import pytest

from autograder.judge import reference_recording
from autograder.judge.one_check import Seen
from autograder.kit.evidence import Event, Evidence, Part, Reference
from autograder.kit.model import Advice, Criterion, Exercise, Finding, Mistake
from tests.cases import named_cases

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence


def _has_first(evidence: Evidence) -> Finding:
    first = evidence.main.of("message")[0].data["number"]
    return Finding(first == 1, "1", str(first))


def _never_right(evidence: Evidence) -> Advice | None:
    return Advice("It says 0.", "Say 1.") if evidence.main.of("message")[0].data["number"] == 0 else None


EXERCISE = Exercise(
    "lab_9_1.talker",
    "",
    "",
    lambda _: None,
    (Criterion("first", "Begins at 1", 10, _has_first),),
    (Mistake("wrong_number", _never_right, certain=True),),
    (),
)


class _Subject:
    def begin(self, _: int) -> None:
        pass


class _Looks:
    """Looks that show a first message of these numbers; None for one that is doubtful.

    A negative number is shown without its sign, in simulated time and in a doubtful look.
    """

    def __init__(self, *numbers: int | None) -> None:
        self.taken = 0
        self._numbers: Iterator[int | None] = iter(numbers)

    def __call__(
        self, _exercise: Exercise, _subject: object, reference: Reference, *_: Any, **__: Any
    ) -> Seen:
        number = next(self._numbers)
        self.taken += 1
        is_doubtful = number is None or number < 0
        sim = 100.0 if number is not None and number < 0 else None
        shown = None if number is None else abs(number)
        message = Event(0.5, "message", "/chatter", {"number": shown, "fields": {"data": shown}}, sim)
        return Seen(Evidence([Part("talking", {}, [message])], reference), is_doubtful)


@pytest.mark.parametrize(
    ("numbers", "recorded", "looks"),
    [
        pytest.param((1,), 1, 1, id="clear at once"),
        pytest.param(
            (2, None, 1), 1, 3, id="the first message was lost once, and once it did not follow the clock"
        ),
        pytest.param((-2, -1, -1), 1, 3, id="two doubtful looks agree"),
        pytest.param((2,) * reference_recording.LOOKS, 2, reference_recording.LOOKS, id="never right"),
        pytest.param((0,), 0, 1, id="surely wrong"),
    ],
)
def test_a_blurred_look_is_followed_by_another(
    monkeypatch: pytest.MonkeyPatch, numbers: tuple[int | None, ...], recorded: int, looks: int
) -> None:
    taken = _record(monkeypatch, look := _Looks(*numbers))
    assert taken.parts[0].events[0].data["number"] == recorded
    assert look.taken == looks


def test_no_look_follows_when_the_time_of_a_check_is_over(monkeypatch: pytest.MonkeyPatch) -> None:
    _record(monkeypatch, look := _Looks(2, 2, 2), replace(EXERCISE, limit=0.0))
    assert look.taken == 1


def test_what_was_doubtful_each_time_is_not_recorded(monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(reference_recording.NotRecordable, match="Wait until the machine is less busy"):
        _record(monkeypatch, _Looks(*(None,) * reference_recording.LOOKS))


def test_a_wrong_answer_is_recorded_in_a_look_that_is_not_doubtful(monkeypatch: pytest.MonkeyPatch) -> None:
    def recorded(look: _Looks) -> Reference:
        monkeypatch.setattr(reference_recording, "look", look)
        beside = Reference("lab_9_1.talker", {}, [Part("of the solution")])
        return reference_recording.record_variant(EXERCISE, cast("Any", _Subject()), beside, domain_id=1)

    (part,) = recorded(_Looks(None, 7)).parts
    assert part.events[0].data["number"] == 7
    (part,) = recorded(_Looks(-7, -8, -7)).parts
    assert part.events[0].data["number"] == 7
    with pytest.raises(reference_recording.NotRecordable, match="does not follow the simulated clock"):
        recorded(_Looks(*range(-reference_recording.LOOKS, 0)))


def test_an_endpoint_that_is_announced_after_the_first_one_is_recorded_too(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    class Bench:
        """Shows the service only to who waits until all is made."""

        def __init__(self, *_: Any) -> None:
            pass

        def __getattr__(self, _: str) -> Any:
            return lambda *_: Part("interface")

        def await_any_endpoint(self, roles: tuple[str, ...]) -> dict[str, dict[str, str]]:
            return {"publisher": {"/blink": "a type"}, "service": {} if roles else {"/lamp": "another"}}

    monkeypatch.setattr(reference_recording, "TestBench", Bench)
    monkeypatch.setattr(reference_recording, "look", _Looks(1))
    exercise = replace(EXERCISE, roles=("publisher", "service"))
    taken = reference_recording.record(exercise, cast("Any", Bench()), domain_id=1)
    assert taken.interface == {"publisher": {"/blink": "a type"}, "service": {"/lamp": "another"}}


def _record(monkeypatch: pytest.MonkeyPatch, look: _Looks, exercise: Exercise = EXERCISE) -> Reference:
    monkeypatch.setattr(reference_recording, "look", look)
    bare = Reference(exercise.id, {})
    monkeypatch.setattr(reference_recording, "_endpoints_of_solution", lambda *_: bare)
    return reference_recording.record(exercise, cast("Any", _Subject()), domain_id=1)


def _said(number: int, name: str) -> Part:
    return Part(name, {}, [Event(0.0, "message", "/chatter", {"fields": {"data": number}})])


@pytest.mark.parametrize(
    ("numbers", "attempt", "recorded"),
    [
        *named_cases(__file__, "a_drawing_of_a_class_is_drawn_again_unless_it_tells"),
        pytest.param((2, None, 2), 0, 2, id="a look is doubtful"),
    ],
)
def test_a_drawing_of_a_class_is_drawn_again_unless_it_tells(
    numbers: tuple[int | None, ...], attempt: int, recorded: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    look = _Looks(*numbers)
    (part,) = _record_drawing(monkeypatch, look).parts
    assert part.name == ("drawing x" if not attempt else f"drawing x.{attempt}")
    assert part.events[0].data["number"] == recorded
    assert look.taken == len(numbers)


def test_a_solution_that_does_not_do_the_same_twice_is_not_recorded(monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(reference_recording.NotRecordable, match="did not do the same twice"):
        _record_drawing(monkeypatch, _Looks(*range(10, 18)))


def test_a_drawing_is_not_drawn_again_if_the_answer_is_always_the_same(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    assert _record_drawing(monkeypatch, _Looks(1, 1), practice=(1, 1)).parts[0].name == "drawing x"


def test_a_drawing_is_not_drawn_again_when_the_time_is_over(monkeypatch: pytest.MonkeyPatch) -> None:
    look = _Looks(1, 1)
    assert _record_drawing(monkeypatch, look, limit=0.0).parts[0].name == "drawing x"


def _record_drawing(
    monkeypatch: pytest.MonkeyPatch, look: _Looks, limit: float = 60.0, practice: Sequence[int] = (1, 9)
) -> Reference:
    def drawn(exercise: Exercise, subject: object, reference: Reference, *more: Any, **options: Any) -> Seen:
        seen = look(exercise, subject, reference, *more, **options)
        named = [replace(part, name=reference.drawings[0]) for part in seen.evidence.parts]
        return replace(seen, evidence=replace(seen.evidence, parts=named))

    def as_the_solution(evidence: Evidence) -> Finding:
        mine, due = (
            part.events[0].data["fields"]["data"] for part in (evidence.main, evidence.reference.parts[0])
        )
        return Finding(mine == due, str(due), str(mine))

    known = Reference("lab_9_1.talker", {}, [_said(one, f"drawing {n}") for n, one in enumerate(practice)])
    monkeypatch.setattr(reference_recording, "look", drawn)
    monkeypatch.setattr(reference_recording, "load_reference", lambda _: known)
    exercise = replace(
        EXERCISE,
        limit=limit,
        criteria=(Criterion("same", "Says the same", 10, as_the_solution),),
        mistakes=(),
    )
    return reference_recording.record_drawing(exercise, cast("Any", _Subject()), "drawing x", domain_id=1)
