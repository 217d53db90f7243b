"""The patterns of :mod:`tests.english`, each with a sentence that it finds and its plain form."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from tests.cases import cases
from tests.english import faults_in, prose_of

if TYPE_CHECKING:
    from pathlib import Path


@pytest.mark.parametrize(("faulty", "plain"), cases(__file__, "a_fault_is_found_and_its_plain_form_is_not"))
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


def test_a_paragraph_that_goes_on_with_the_sentence_of_a_block_is_found(tmp_path: Path) -> None:
    page = tmp_path / "page.md"
    page.write_text("Type\n\n```console\n$ ./course\nno page\n```\n\nmakes a class.\n\nIt is yours.\n")
    assert [number for number, line in prose_of(page) if faults_in(line)] == [8]


def test_the_texts_of_a_table_are_read_and_its_changes_are_not(tmp_path: Path) -> None:
    table = tmp_path / "answers.toml"
    texts = '["a.py"]\ncard = "It reads\\na text that is no JSON"\nchange = "+# this is no text"\nnext_step = "Stop."\n'
    table.write_text(texts)
    assert [line for _, line in prose_of(table) if faults_in(line)] == ["a text that is no JSON"]
    assert dict(prose_of(table))[4] == "Stop."
