"""Text of unknown origin, made legible."""

from __future__ import annotations

import json
import sys

import pytest

from autograder.cards.readable_text import _escaped, block, label, one_line, paragraph, width, wrap
from autograder.standard_output import printable_json
from tests.cases import cases


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        *cases(__file__, "one_line_writes_out_what_cannot_be_seen"),
        ("\ud800", "\\ud800"),
    ],
)
def test_one_line_writes_out_what_cannot_be_seen(text: str, shown: str) -> None:
    assert one_line(text, 100) == shown


def test_no_printable_character_is_escaped() -> None:
    """Why a printable text need not be walked."""
    printable = filter(str.isprintable, map(chr, range(sys.maxunicode + 1)))
    assert [character for character in printable if _escaped(character) != character] == []


def test_one_line_cuts_in_the_middle() -> None:
    cut = one_line("begin" + "x" * 1000 + "end", 20)
    assert len(cut) == 20
    assert cut.startswith("begin")
    assert cut.endswith("end")
    assert "…" in cut


@pytest.mark.parametrize("text", ["\x00" * 100_000, "x" * 100_000, "\u202e" * 9, "y" * 10])
def test_one_line_keeps_its_limit(text: str) -> None:
    assert len(one_line(text, 10)) <= 10


def test_paragraph_joins_lines() -> None:
    assert paragraph("  one\n  two\tthree ", 100) == "one two three"


def test_block_keeps_lines_and_drops_colours_only() -> None:
    assert block("\x1b[1;31mError\x1b[0m\r\n\tat \x07\n", max_lines=5, max_columns=40) == [
        "Error",
        "    at \\x07",
    ]


def test_block_keeps_the_end_and_counts_what_it_leaves_out() -> None:
    lines = block("\n".join(map(str, range(100))), max_lines=10, max_columns=40)
    assert len(lines) == 10
    assert lines[0] == "0"
    assert lines[-1] == "99"
    assert int(lines[3].split()[1]) == 100 - 9


def test_width_counts_columns() -> None:
    assert [width("abc"), width("你好"), width("e\u0301"), width("")] == [3, 4, 1, 0]


def test_wrap_breaks_at_blanks_and_long_words_anywhere() -> None:
    assert wrap("one two three", 9, "> ", "  ") == ["> one two", "  three"]
    assert wrap("abcdefghij k", 6, "", " ") == ["abcdef", " ghij", " k"]
    assert wrap("你好你好", 5) == ["你好", "你好"]
    assert wrap("", 5, "> ") == [">"]


def test_no_wrapped_line_is_wider_than_asked_for() -> None:
    text = "a e\u0301e\u0301 你好你好你 longer-than-a-line-can-be x\u200dy 你 bb"
    lines = wrap(text, 9, "> ", "… ")
    assert max(map(width, lines)) == 9
    assert "".join("".join(line[2:] for line in lines).split()) == "".join(text.split())


def test_printed_json_moves_no_cursor_and_reads_back_the_same() -> None:
    said = "C1 \x9b2J, bidi \u202e, tag \U000e0041, separator \u2028, surrogate \ud800, Grüße, 你好"
    printed = printable_json(json.dumps({"said": said}, ensure_ascii=False))
    assert printed.isprintable()
    assert "Grüße, 你好" in printed
    assert json.loads(printed) == {"said": said}


@pytest.mark.parametrize(("text", "shown"), cases(__file__, "a_label_is_cut_between_its_values"))
def test_a_label_is_cut_between_its_values(text: str, shown: str) -> None:
    limit = 22 if text.startswith("[") else 31
    assert label(text, limit) == shown
