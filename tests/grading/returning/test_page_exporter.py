"""Texts are remembered by all they depend on, and no more of them than fit."""

from __future__ import annotations

from autograder.grading.returning.page_exporter import RenderedTexts


class Maker:
    """Makes the text of a value, and notes it."""

    def __init__(self, characters: int) -> None:
        self.made: list[object] = []
        self._texts = RenderedTexts(characters)

    def get(self, of: object, length: int = 10) -> str:
        def make() -> str:
            self.made.append(of)
            return repr(of)[:1].ljust(length, ".")

        return self._texts.get(of, make)


def test_a_text_is_made_once_and_whatever_differs_is_made_anew() -> None:
    maker = Maker(1000)
    inner: tuple[object, ...] = (1, "1", 1.5, {}, [])
    values: list[object] = ["", "a", ["a"], *({"a": of} for of in inner), None, 1, True]
    for value in values * 2:
        maker.get(value)
    assert len(maker.made) == len(values)


def test_the_longest_unused_goes_first() -> None:
    maker = Maker(30)
    for value in ("a", "b", "c", "a", "d", "a", "c", "d"):
        maker.get(value)
    assert maker.made == ["a", "b", "c", "d"]
    maker.get("b")
    assert maker.made[4:] == ["b"]
    maker.get("a")
    assert maker.made[5:] == ["a"]


def test_what_does_not_fit_is_made_all_the_same() -> None:
    maker = Maker(30)
    assert len(maker.get("long", 31)) == 31
    maker.get("a")
    maker.get("a")
    assert maker.made == ["long", "a"]
    maker.get("long", 31)
    assert maker.made == ["long", "a", "long"]
