"""Lines of any length, cut."""

from __future__ import annotations

import io

from autograder.short_lines import short_lines


def test_a_long_line_is_cut_and_the_next_one_is_whole() -> None:
    stream = io.BytesIO(b"first\n" + b"x" * 1_100_000 + b"\nlast\nno end")
    assert list(short_lines(stream, 100)) == [b"first\n", b"x" * 100, b"last\n", b"no end"]


def test_a_line_of_just_that_length_is_no_two_lines() -> None:
    assert list(short_lines(io.BytesIO(b"1234\n12345\n1\n"), 5)) == [b"1234\n", b"12345", b"1\n"]
