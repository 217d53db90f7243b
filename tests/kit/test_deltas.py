"""A run that is a mutant's is named by what the mutant does; one that no mutant has made is not."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import pytest

from autograder.kit.evidence import Event, Part
from autograder.kit.oracle.naming import mutant_words
from autograder.kit.oracle.naming.deltas import Meaning, MutantClass, Mutants, alike, differences, meanings_of
from autograder.kit.oracle.naming.effects import effect
from autograder.kit.oracle.outputs import Kind, Output
from tests.cases import cases

if TYPE_CHECKING:
    from autograder.kit.model import Advice

SAID = Output("/said", ("data",), Kind.STEPS, 1e-3)
MOVED = Output("/moved", ("data",), Kind.STEPS, 1e-3)
LAW = "stop where the wall is nearer than 0.8 m"


def run(said: list[Any], moved: list[Any] | None = None, *, name: str = "drawing 0") -> Part:
    """A run in which the node said one value in each step, or nothing where it is None."""
    told = {"/said": said, "/moved": moved or [0.0] * len(said)}
    noted = [
        Event(0.0, "noted", output, {"step": step, "given": "", "values": [] if value is None else [[value]]})
        for output, values in told.items()
        for step, value in enumerate(values, 1)
    ]
    return Part(name, {}, noted)


DUE = run(["far", "far", "near", "near", "far"])
MEANINGS = [
    Meaning("number", "times 0.5", 7, 20, LAW, right=0.8, value=0.4),
    Meaning("number", "times 0.8", 7, 20, LAW, right=0.8, value=0.64),
    Meaning("number", "times 1.5", 7, 20, LAW, right=0.8, value=1.2),
    Meaning("condition", "never", 7, 18, LAW),
    Meaning("dropped", "", 9, 40, name="act"),
    Meaning("turned", "", 7, 19, LAW),
]


def mutants(*classes: tuple[list[int], dict[str, dict[int, Any]]]) -> Mutants:
    """Classes of mutants, each with what it says differently in the only drawing."""
    kept = [MutantClass(meanings, {"drawing 0": parts}) for meanings, parts in classes]
    return Mutants("", MEANINGS, kept, solution=[DUE])


def named(seen: Part, of: Mutants) -> Advice | None:
    apart = differences([SAID, MOVED], seen, DUE)
    return mutant_words.advice(meanings_of(of, apart, 1e-3), of)


NEVER_NEAR = {"/said": {3: [["far"]], 4: [["far"]]}}


def test_a_number_is_named_with_the_task_s_sentence_and_the_numbers_beside_it() -> None:
    of = mutants(
        ([1], {"/said": {3: [["far"]]}}), ([0], NEVER_NEAR), ([2], {"/said": {1: [["near"]], 2: [["near"]]}})
    )
    told = named(run(["far"] * 5), of)
    assert told is not None
    assert told.key == "other_number"
    assert told.text == f"It is as if another number stood in “{LAW}” (yours: below 0.64)."


def test_of_mutants_at_one_place_the_effect_is_named() -> None:
    told = named(run(["far"] * 5), mutants(([0, 3], NEVER_NEAR)))
    assert told is not None
    assert told.key == "condition_ignored"
    assert LAW in told.text


def test_mutants_of_several_meanings_name_nothing() -> None:
    assert named(run(["far"] * 5), mutants(([0, 4], NEVER_NEAR))) is None


def test_mutants_of_one_kind_at_several_places_have_the_words_that_are_true_wherever_it_is() -> None:
    """An object that all share is as one whose value belongs to its class."""
    shared, made_once = (Meaning("on_the_class", "", 3, 9), Meaning("made_once", "", 8, 50))
    never = Meaning("condition", "never", 7, 18)
    for found, text in (([made_once, shared], "The next object still has"), ([never, made_once, shared], "")):
        told = mutant_words.advice(found, mutants())
        assert (told.text if told else "").startswith(text)
        assert bool(told) is bool(text)


def test_a_run_of_no_mutant_is_not_named() -> None:
    assert named(run(["far", "far", "near", "far", "near"]), mutants(([0], NEVER_NEAR))) is None


def test_a_failed_output_is_named_by_itself_if_the_run_as_a_whole_is_no_mutant_s() -> None:
    seen = run(["far"] * 5, [0.0, 0.0, 1.0, 0.0, 0.0])
    told = named(seen, mutants(([0], NEVER_NEAR)))
    assert told is not None
    assert told.key == "other_number"


def test_one_step_alone_tells_nothing_but_another_number_or_its_limit() -> None:
    apart = differences([SAID], run(["far", "far", "near", "far", "far"]), DUE)
    assert not apart.tells
    # A machine may lose a message, and none of the values that a function returned.
    returned = Output("/said", ("data",), Kind.RETURNED, 1e-3)
    assert differences([returned], run(["far", "far", "near", "far", "far"]), DUE).tells
    assert not differences([returned], DUE, DUE).tells
    assert mutant_words.is_one_limit(MEANINGS[:3])
    assert not mutant_words.is_one_limit(MEANINGS[:4])
    assert not mutant_words.is_one_limit([])


@pytest.mark.parametrize(
    ("one", "other", "is_alike"), cases(__file__, "messages_of_one_instant_may_come_in_any_order")
)
def test_messages_of_one_instant_may_come_in_any_order(one: Any, other: Any, *, is_alike: bool) -> None:
    assert alike(one, other, 1e-3) is is_alike


NUMBERS = [1.0, -2.0, 0.5, 3.0, -1.0]


@pytest.mark.parametrize(
    ("seen", "due", "text"),
    [
        *cases(__file__, "one_sentence_says_how_a_whole_output_differs"),
        ([-one for one in NUMBERS], NUMBERS, "What your node says on /said has the wrong sign."),
        ([abs(one) for one in NUMBERS], NUMBERS, "What your node says on /said has lost its sign."),
        ([2 * one for one in NUMBERS], NUMBERS, "What your node says on /said is 2 times what is due."),
        (
            [9.0, *NUMBERS[:-1]],
            NUMBERS,
            "What your node says on /said comes one step late: it is what was due before.",
        ),
        (
            [1.0, -2.0, 7.0, 7.0, 7.0],
            NUMBERS,
            "What your node says on /said is right at first, and then always 7.",
        ),
        (["far", None, "near"], ["far", "near", "near"], ""),
        (
            ["far", "near", None, None, "up"],
            ["far", "near", "far", "near", "up"],
            "A message that your node has said on /said once, it never says again.",
        ),
        # says what is new
        (["far", None, "near", None], ["far", "far", "near", "near"], ""),
    ],
)
def test_one_sentence_says_how_a_whole_output_differs(seen: list[Any], due: list[Any], text: str) -> None:
    def values(listed: list[Any]) -> dict[int, Any]:
        return {step: [] if one is None else [[one]] for step, one in enumerate(listed)}

    told = effect(SAID, values(seen), values(due))
    assert (told.text if told else "") == text


@pytest.mark.parametrize(("doubled", "text"), [(3, "Your node says everything on /said twice."), (2, "")])
def test_everything_comes_twice_only_if_each_message_does(doubled: int, text: str) -> None:
    due = {step: [[word]] for step, word in enumerate(("far", "near", "far"))}
    seen = {step: rows * (2 if step < doubled else 1) for step, rows in due.items()}
    told = effect(SAID, seen, due)
    assert (told.text if told else "") == text
