"""What counts of an answer, and what its writer may choose."""

from __future__ import annotations

import pytest

from autograder.grading.similarity.own_words import chosen_names, neutral_words, words
from tests.cases import cases


@pytest.mark.parametrize(("text", "expected"), cases(__file__, "words"))
def test_words(text: str, expected: tuple[str, ...]) -> None:
    found = list(words(text))
    assert tuple(word.text for word in found) == expected
    assert tuple(text[word.start : word.end] for word in found) == expected


def test_names_that_somebody_has_chosen() -> None:
    text = """
class Mine(Node):
    def work(self, first, second: int = 3, *rest, **options):
        self.total = call(first, keyword=1)
        self.typed: int = 3
        x, y = 4, 5
        with Event() as event:
            for number, name in enumerate(rest):
                if (found := look(name)) == other:
                    return library.function(found)
"""
    assert chosen_names(list(words(text))) == {
        *("Mine", "work", "first", "second", "rest", "options"),
        *("total", "event", "number", "name", "found", "typed", "x", "y"),
    }


def test_other_names_and_texts_are_the_same_answer() -> None:
    one, other = list(words("a = say('x', 'task')")), list(words("bb = say('yy', 'task')"))
    assert neutral_words(one, {"a"}, {"'task'"}) == neutral_words(other, {"bb"}, {"'task'"})
    assert neutral_words(one, {"a"}, {"'x'", "'task'"}) != neutral_words(other, {"bb"}, {"'task'"})
