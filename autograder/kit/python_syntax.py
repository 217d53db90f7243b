"""What Python says of a text that it cannot read: the rows of ``python_errors`` about them."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence

    from autograder.kit.python_names import Row

_READS = r"^(?:SyntaxError|IndentationError|TabError): "

READING: Sequence[Row] = (
    (
        rf"{_READS}expected ':'",
        "A colon is missing.",
        "Write a colon at the end of that line: class, def, if, else, for, while, try and with all end with one.",
    ),
    (
        rf"{_READS}expected an indented block after (?P<what>.*) on line (?P<line>\d+)",
        "The lines that belong to the {what} are not indented.",
        "Indent by four spaces what belongs below line {line}.",
    ),
    (
        rf"{_READS}unexpected indent",
        "That line is indented further than the line above it, and nothing above it opens a block.",
        "Indent it like the line above.",
    ),
    (
        rf"{_READS}unindent does not match",
        "That line begins between two levels of indentation.",
        "Indent it like the other lines of its block: by four spaces for each level.",
    ),
    (
        rf"{_READS}inconsistent use of tabs",
        "Some lines begin with tabs and others with spaces.",
        "Delete the spaces and tabs at the beginning of that line, and indent it by four spaces for each level.",
    ),
    (
        rf"{_READS}'(?P<sign>.)' was never closed",
        "The bracket {sign} is opened and never closed.",
        "Count the brackets of that line, and close this one.",
    ),
    (
        rf"{_READS}unmatched '(?P<sign>.)'",
        "There is one {sign} too many.",
        "Count the brackets of that line.",
    ),
    (
        rf"{_READS}(?:unterminated|EOL while scanning|f-string: expecting)",
        "A string does not end.",
        "Close it with the quotation mark that it begins with, and each {{ in an f-string with a }}.",
    ),
    (
        rf"{_READS}invalid (?:non-printable )?character '?(?P<sign>[^']*)",
        "That line has a character of a word processor or a web page in it.",
        "Type the line yourself: quotation marks are ' or \" and a minus is -.",
    ),
    (
        rf"{_READS}.*Maybe you meant '=='",
        "One = gives a variable a value; to compare takes two.",
        "Write == in a condition. Left of a single = is the name that gets the value.",
    ),
    (
        rf"{_READS}.*forgot a comma",
        "Two values are side by side, and nothing joins them.",
        "Put a string in quotation marks, write a comma between two values, or close the bracket or the quotation mark "
        "before that place.",
    ),
    (
        rf"{_READS}Missing parentheses in call to 'print'",
        "This is Python 2.",
        "Write print(...), with parentheses.",
    ),
    (
        rf"{_READS}'return' outside function",
        "That line is not inside a method any more.",
        "Indent it as the other lines of its method.",
    ),
    (
        rf"{_READS}incomplete input",
        "The code ends in the middle of something.",
        "Close each bracket and each quotation mark that you have opened, or write the line that is missing.",
    ),
    (
        _READS,
        "",
        "Go to the line that the message names; a bracket, a quote, a colon or the indentation is off there or just "
        "before it.",
    ),
)
"""Python's words about a text that it cannot read; the first row that fits wins."""
