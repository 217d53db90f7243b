"""The patterns of :mod:`tests.english`, each with a sentence that it finds and its plain form."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from tests.english import faults_in, prose_of

if TYPE_CHECKING:
    from pathlib import Path


@pytest.mark.parametrize(
    ("faulty", "plain"),
    [
        ("None where the name says none", "None if the name contains none"),
        ("The channel that nobody reads.", "The channel that no process reads."),
        ("The solution is no Python.", "The solution is not valid Python."),
        ("Who ends at once has not given up.", "A client that ends at once has not given up."),
        ("What the judge saw.", "The events that the judge saw."),
        ("Begin anew, also where it failed.", "Begin again, even if it failed."),
        ("It says something else than its name.", "The content of the file differs from its name."),
        ("A box that is there.", "A running sandbox."),
        ("Its outcome.", "The outcome of this file."),
        ("Recognise the colour.", "Recognize the color."),
    ],
)
def test_a_fault_is_found_and_its_plain_form_is_not(faulty: str, plain: str) -> None:
    assert faults_in(faulty)
    assert not faults_in(plain)


def test_prose_is_strings_and_comments(tmp_path: Path) -> None:
    module = tmp_path / "module.py"
    module.write_text('"""One.\n\nTwo."""\nnobody = 1  # three\nsaid = f"four {nobody} five"\n')
    lines = list(prose_of(module))
    assert lines[:4] == [(1, "One."), (2, ""), (3, 'Two."""'), (4, "three")]
    assert all(number == 5 for number, _ in lines[4:])
    assert "four" in "".join(line for _, line in lines[4:])


def test_there_is_no_is_english() -> None:
    assert not faults_in("There is no reply, and the reply is no longer needed.")
