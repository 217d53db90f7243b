"""What a program raises on purpose, told from what just happens to it."""

from __future__ import annotations

import pytest

from autograder.kit.meant_errors import meant

HEAD = 'Traceback (most recent call last):\n  File "client.py", line 9, in <module>\n    main()\n'


@pytest.mark.parametrize(
    ("rest", "expected"),
    [
        ('  File "client.py", line 5, in run\n    raise GoalFailed("refused")\nGoalFailed: refused', True),
        (
            '  File "client.py", line 5, in run\n    assert handle.accepted, "refused"\nAssertionError: refused',
            True,
        ),
        (
            '  File "client.py", line 5, in run\n    x = names[7]\n        ~~~~~^^^\nIndexError: out of range',
            False,
        ),
        (
            '  File "client.py", line 5, in run\n    node.send(1)\n'
            '  File "/venv/lib/python3.11/site-packages/rclpy/action/client.py", line 3, in send\n'
            "    raise TypeError()\nTypeError",
            False,
        ),
        ("RuntimeError: no line of the program is known", False),
    ],
)
def test_the_innermost_line_tells(rest: str, expected: bool) -> None:
    assert meant(HEAD + rest) is expected


def test_nothing_is_meant_by_nothing() -> None:
    assert not meant("")
