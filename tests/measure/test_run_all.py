"""``python -m tests.measure run_all`` sees a workspace that changes, points that are lost and cells that fail.

The notebooks of the chapter take too long to be run five times here. What they do to files, and only that, is done
again and again in ``tests/masters/test_run_again.py``.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from nbformat.v4 import new_code_cell, new_notebook

from tests.measure.run_all import Left, again_and_again, differences, orders

if TYPE_CHECKING:
    from pathlib import Path

    import pytest
    from nbformat import NotebookNode

WRITES = """
from pathlib import Path
file = Path("ros2_ws/src/pkg/setup.py")
file.parent.mkdir(parents=True, exist_ok=True)
"""
A_CHECK = {"nbgrader": {"grade": True, "solution": False}}


def notebook(*sources: str) -> NotebookNode:
    return new_notebook(
        cells=[
            new_code_cell(source, metadata=A_CHECK if source.startswith("check(") else {})
            for source in sources
        ]
    )


def test_what_can_be_run_again_and_what_cannot(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    notebooks = {
        "writes": notebook(f"{WRITES}file.write_text('one')"),
        "appends": notebook(f"{WRITES}file.write_text(file.read_text() + 'two')\nprint('loud')", "1 / 0"),
        "lies": notebook("def check(name): pass", "check('lab_1_1.hello')"),
    }
    (tmp_path / "good").mkdir()
    assert again_and_again(notebooks, [["writes"], ["writes"]], tmp_path / "good") == []
    (tmp_path / "bad").mkdir()
    wrong = again_and_again(notebooks, [["writes"], ["appends", "lies"]], tmp_path / "bad")
    assert [line.split(":")[1].strip() for line in wrong] == [
        "appends",
        "0 checks were made, and 1 are asked for",
        "pkg/setup.py",
    ]
    assert "ZeroDivisionError" in wrong[0]
    assert "loud" not in capsys.readouterr().out


def test_what_differs_is_named() -> None:
    first = Left({"a": b"1", "b": b"1"}, frozenset({"ros2_ws"}))
    now = Left({"a": b"2", "c": b"1"}, frozenset({"ros2_ws", "server.log"}))
    assert differences(first, first) == []
    assert differences(first, now) == [
        "a: differs", "b: is gone", "c: is new", "server.log: lies there in one of the passes only",
    ]  # fmt: skip


def test_the_order_of_the_chapter_thrice_and_then_mixed() -> None:
    names = [str(number) for number in range(12)]
    passes = orders(names, seed=0)
    assert passes[:3] == [names] * 3
    assert len(passes) == 5
    assert all(sorted(mixed) == sorted(names) and list(mixed) != names for mixed in passes[3:])
    assert orders(names, seed=0) == passes
