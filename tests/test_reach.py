"""Which tests ``./course test --changed`` selects, in a small made-up repository."""

from __future__ import annotations

import subprocess
import tomllib
from pathlib import Path
from typing import Any

import pytest

from tests.reach import changes
from tests.reach.changes import NoCommit, Selection, reaching, selection
from tests.reach.roots import read_files

MADE_UP = tomllib.loads((Path(__file__).parent / "reach" / "made_up.toml").read_text(encoding="utf-8"))
FILES: dict[str, str] = MADE_UP["files"]


def written(root: Path) -> None:
    """Write the made-up repository into a folder."""
    for name, text in FILES.items():
        (root / name).parent.mkdir(parents=True, exist_ok=True)
        (root / name).write_text(text)


@pytest.mark.parametrize("case", MADE_UP["change"], ids=lambda case: f"{case['file']}-{case['new']}")
def test_a_change_selects_the_tests_that_reach_it(tmp_path: Path, case: dict[str, Any]) -> None:
    written(tmp_path)
    path, before = case["file"], FILES[case["file"]]
    assert case["old"] in before
    (tmp_path / path).write_text(before.replace(case["old"], case["new"]))
    chosen = reaching(tmp_path, read_files(tmp_path, FILES), [path], {path: before}.get)
    assert {name.removeprefix("tests/") for name in chosen.tests} | chosen.about == set(case["selected"])


def test_of_more_tests_than_a_change_needs_the_nearest_are_selected(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(changes, "MOST", 1)
    written(tmp_path)
    (tmp_path / "autograder/marks.py").write_text("def total(marks):\n    return 0\n")
    before = {"autograder/marks.py": FILES["autograder/marks.py"]}
    files = read_files(tmp_path, FILES)
    (name,) = reaching(tmp_path, files, before, before.get).tests
    assert name.startswith("tests/test_marks.py::")  # another test reaches it through the commands


def test_parameters_that_name_an_exercise_are_selected_one_by_one() -> None:
    chosen = Selection(
        "", (), frozenset({"tests/test_page.py::test_page"}), frozenset({"lab_a", "lab_a.talker"})
    )
    ids = (
        "test_page.py::test_page[any]",
        "test_bank.py::test_bank[lab_a.talker/right/one.py]",
        "test_x.py::test_x[01-lab_a]",
    )
    assert all(chosen.includes(f"tests/{one}") for one in ids)
    others = ("test_bank.py::test_bank[lab_b.server]", "test_bank.py::test_bank", "test_page.py::test_pages")
    assert not any(chosen.includes(f"tests/{one}") for one in others)
    assert Selection.from_json(chosen.as_json()) == chosen


def test_the_base_is_a_commit_and_what_decides_on_each_test_selects_all(tmp_path: Path) -> None:
    def git(*words: str) -> None:
        who = ("-c", "user.name=a", "-c", "user.email=a@b")
        subprocess.run(["git", *who, *words], cwd=tmp_path, check=True, capture_output=True)

    written(tmp_path)
    git("init", "-q")
    git("add", ".")
    git("commit", "-q", "-m", "one")
    (tmp_path / "autograder/worker.py").write_text("def run():\n    return 5\n")
    git("commit", "-q", "-a", "-m", "two")
    (tmp_path / "autograder/marks.py").write_text(
        FILES["autograder/marks.py"].replace("FULL = 10", "FULL = 9")
    )
    assert selection(tmp_path, "").files == ("autograder/marks.py", "autograder/worker.py")
    assert selection(tmp_path, "HEAD").tests == {"tests/test_marks.py::test_best"}
    (tmp_path / "tests/tiers.py").write_text("")  # also one that is not committed
    assert selection(tmp_path, "HEAD").includes("tests/test_queries.py::test_names")
    with pytest.raises(NoCommit):
        selection(tmp_path, "nothing")
