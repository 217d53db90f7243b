"""No notebook gets more words, or a longer way to the next thing to do; and the count sees what a student sees."""

from __future__ import annotations

from typing import TYPE_CHECKING

import nbformat
from nbformat import v4

from tests.chapter_words import Words, above, ceilings, notebooks, words_of

if TYPE_CHECKING:
    from pathlib import Path


def counted(folder: Path, *cells: nbformat.NotebookNode) -> Words:
    """The words of a notebook with these cells."""
    path = folder / "lab.ipynb"
    nbformat.write(v4.new_notebook(cells=list(cells)), path)
    return words_of(path)


def test_no_notebook_has_more_words_than_its_ceiling() -> None:
    assert above(notebooks(), ceilings()) == []


def test_a_ceiling_has_a_notebook() -> None:
    assert set(ceilings()) <= set(notebooks())


def test_what_is_folded_is_not_visible_and_its_summary_is(tmp_path: Path) -> None:
    text = "One two.\n\n<details><summary>Three</summary>\n\nFour five six.\n</details>"
    words = counted(tmp_path, v4.new_markdown_cell(text))
    assert (words.visible, words.folded) == (3, 3)


def test_comments_docstrings_labels_and_printed_text_are_words(tmp_path: Path) -> None:
    (tmp_path / "a.svg").write_text("<svg><text>label</text></svg>")
    code = v4.new_code_cell('def drive():\n    """Drives on."""\n    return 1  # a number')
    code.outputs = [v4.new_output("stream", text="said so\n")]
    assert counted(tmp_path, v4.new_markdown_cell("![](a.svg)"), code).visible == 1 + 2 + 2 + 2


def test_a_shell_cell_has_its_comments(tmp_path: Path) -> None:
    assert counted(tmp_path, v4.new_code_cell("%%bash\n# list them\nros2 topic list")).visible == 2


def test_a_question_and_a_cell_to_write_end_a_gap_and_a_cell_to_run_does_not(tmp_path: Path) -> None:
    write = v4.new_code_cell("pass", metadata={"nbgrader": {"solution": True}})
    words = counted(
        tmp_path,
        v4.new_markdown_cell("One two."),
        v4.new_code_cell("run()"),
        v4.new_markdown_cell(
            "Three. What?\n\n<details><summary>Answer</summary>\n\nThat.\n</details>\n\nAnd on."
        ),
        write,
        v4.new_markdown_cell("Last."),
    )
    assert words.gaps == (4, 3, 1)
    assert words.things_to_do == 2


def test_a_question_with_choices_is_one_thing_to_do_and_a_hint_is_none(tmp_path: Path) -> None:
    choices = "<details><summary>A</summary>\n\n✗ No.\n</details>\n<details><summary>B</summary>\n\n✓ Yes.\n</details>"
    hint = "<details><summary>Where?</summary>\n\nHere.\n</details>"
    words = counted(tmp_path, v4.new_markdown_cell(f"Which?\n\n{choices}\n\nText.\n\n{hint}"))
    assert words.things_to_do == 1


def test_a_notebook_without_a_ceiling_has_the_usual_one() -> None:
    assert above({"02/new.ipynb": Words(1701, 0, (100, 251))}, {}) == [
        "02/new.ipynb: 1701 visible words; 1700 are allowed.",
        "02/new.ipynb: 251 words without a thing to do; 250 are allowed.",
    ]
