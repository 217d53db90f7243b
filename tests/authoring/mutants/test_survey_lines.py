"""An author reads which piece of which line a mutant changes, and into what."""

import pytest

from autograder.authoring.mutants.code import Code
from autograder.authoring.mutants.engine import mutants, python_changes
from autograder.authoring.mutants.solutions import Solution
from autograder.authoring.mutants.survey_lines import in_words
from tests.cases import named_cases

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


@pytest.mark.parametrize("line", named_cases(__file__, "a_change_is_shown_where_it_is"))
def test_a_change_is_shown_where_it_is(line: str) -> None:
    assert line in SAID, "\n".join(SAID)
