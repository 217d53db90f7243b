"""An answer of a process that a student may have taken over is used only in the form that it has to have."""

from __future__ import annotations

import msgspec
import pytest

from autograder.boxes.admission import NotAdmitted, admitted


class Answer(msgspec.Struct):
    names: tuple[str, ...]


@pytest.mark.parametrize(
    "data",
    [
        *(b"", b"\xff", b"null", b"[]", b'{"names": 1}', b'{"names": ["\xff"]}', b'{"names": ["\\ud800"]}'),
        *(b"[" * 900_000, b'{"others": ' + b"[" * 900_000),
    ],
)
def test_what_has_another_form_is_refused_with_one_error(data: bytes) -> None:
    with pytest.raises(NotAdmitted, match="it has another form"):
        admitted(data, Answer, 1_000_000)


def test_what_is_too_large_is_refused_even_if_it_has_the_right_form() -> None:
    data = b'{"names": ["a"]}'
    assert admitted(data, Answer, len(data)) == Answer(("a",))
    with pytest.raises(NotAdmitted, match="16 bytes; the limit is 15"):
        admitted(data, Answer, 15)
