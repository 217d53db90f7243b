"""An author reads which piece of which line a mutant changes, and into what."""

import pytest

from autograder.authoring.mutants.code import Code
from autograder.authoring.mutants.engine import mutants, python_changes
from autograder.authoring.mutants.solutions import Solution
from autograder.authoring.mutants.survey_lines import in_words

TEXT = """
def limits(name):
    low, high = {"width": (0, 5), "depth": (0, 3), "times": (1, 5), "height": (1, 7)}[name]
    self.buzzer.publish(Int32(data=name["times"]))
    self.answer("ok")
    return low
"""
SAID = [
    in_words(Solution("lab.limits", TEXT, "limits", ((0, len(TEXT)),)), mutant)
    for mutant in mutants(TEXT, python_changes(Code(TEXT)))
]


@pytest.mark.parametrize(
    "line",
    [
        '“low, high = {"width": (0, »5«), "depth": (0, 3), "times": (1…”: number, one more: 5 → 6',
        '“… "depth": (0, 3), "times": (1, »5«), "height": (1, 7)}[name]”: number, one more: 5 → 6',
        '“…), "depth": (0, 3), "times": (1, 5), "height": (1, 7)}[name]”: number, one more: 7 → 8',
        '“self.answer("ok")”: swapped: self.answer("ok") return low → return low self.answer("ok")',
        '“self.buzzer.publish(Int32(data=name["times"]))”: seldom, only if new',
    ],
    ids=[
        "the first of two",
        "the second of two",
        "the end of a long line",
        "two statements",
        "code that keeps values",
    ],
)
def test_a_change_is_shown_where_it_is(line: str) -> None:
    assert line in SAID, "\n".join(SAID)
