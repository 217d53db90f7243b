"""Texts stored as edits: what they make of their base, and what is said where they do not fit it."""

from __future__ import annotations

import pytest

from autograder.authoring.answer_tables import CannotEdit, edited_text

BASE = """import rclpy

def main():
    rclpy.init()
    node = make()
    try:
        rclpy.spin(node)
    finally:
        rclpy.shutdown()

def again():
    rclpy.init()
"""


@pytest.mark.parametrize(
    ("change", "old", "new"),
    [
        pytest.param("-    node = make()\n+    node = take()\n", "make", "take", id="another line"),
        pytest.param("-    node = make()\n", "    node = make()\n", "", id="a line less"),
        pytest.param(
            " def main():\n+    pass\n", "def main():\n", "def main():\n    pass\n", id="a line more"
        ),
        pytest.param(
            "+import time\n import rclpy\n",
            "import rclpy\n",
            "import time\nimport rclpy\n",
            id="a line in front",
        ),
        pytest.param(
            " def again():\n-    rclpy.init()\n+    rclpy.init(args=None)\n",
            "again():\n    rclpy.init()",
            "again():\n    rclpy.init(args=None)",
            id="the second of two places",
        ),
        pytest.param(
            " import rclpy\n\n-def main():\n+def run():\n",
            "def main",
            "def run",
            id="an empty line that stays",
        ),
        pytest.param(
            "-    node = make()\n+    node = 'a\\nb'\n", "make()", "'a\\nb'", id="a backslash is a backslash"
        ),
    ],
)
def test_a_change_is_made(change: str, old: str, new: str) -> None:
    assert edited_text(BASE, change) == BASE.replace(old, new)


def test_several_places_are_changed_in_any_order() -> None:
    places = ["-    node = make()\n+    node = take()", "-import rclpy\n+import rclpy as ros"]
    there = BASE.replace("make", "take").replace("import rclpy", "import rclpy as ros")
    assert edited_text(BASE, "\n...\n".join(places)) == there
    assert edited_text(BASE, "\n...\n".join(reversed(places)) + "\n") == there


@pytest.mark.parametrize(
    ("change", "words"),
    [
        pytest.param(
            "-    node = made()\n+    node = take()\n",
            "'    node = made.*' is not a line of the base",
            id="nowhere",
        ),
        pytest.param(
            "-    rclpy.init()\n",
            r"occurs in the base 2 times \(lines 4, 12\): add the line before",
            id="twice",
        ),
        pytest.param(
            "-import rclpy\n-def main():\n", "there the lines do not follow each other", id="not in a row"
        ),
        pytest.param(" def main():\n", "' def main.*changes nothing", id="only lines that stay"),
        pytest.param("-import rclpy\n+import rclpy\n", "changes nothing", id="the same line"),
        pytest.param("+import time\n", "does not say where to add", id="a line without a place"),
        pytest.param("import time\n", "does not begin with -, [+] or a space", id="a sign is missing"),
        pytest.param("", "changes nothing", id="empty"),
        pytest.param(
            " def main():\n-    rclpy.init()\n...\n     rclpy.init()\n-    node = make()\n",
            "share the line '    rclpy.init[(][)]'",
            id="places that overlap",
        ),
    ],
)
def test_what_does_not_fit_is_said(change: str, words: str) -> None:
    with pytest.raises(CannotEdit, match=words):
        edited_text(BASE, change)
