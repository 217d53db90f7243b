"""Each part of the code is at most as large as its ceiling in ``tests/size_ceilings.toml`` (:mod:`tests.size`)."""

from __future__ import annotations

import subprocess
import tomllib
from collections import Counter
from pathlib import Path
from typing import Any

import pytest

from tests.cases import cases
from tests.size import (
    CEILINGS,
    DECISIONS,
    ROOT,
    WORDS,
    files_at,
    files_of_the_course,
    growth,
    lowered,
    module_of,
    part_of,
    sizes,
    wrong_ceilings,
)


def test_no_part_is_larger_than_its_ceiling() -> None:
    wrong = wrong_ceilings(
        sizes(files_of_the_course()), tomllib.loads(CEILINGS.read_text()), DECISIONS.read_text()
    )
    assert not wrong, "\n".join(
        [
            "",
            *wrong,
            "To lower ceilings, type: python -m tests.size",
            "To raise one, see tests/size.py.",
        ]
    )


def test_no_ceiling_is_above_an_earlier_one() -> None:
    """Compare with the versions in Git since the ceilings were set anew, which the key ``since`` dates."""
    now = tomllib.loads(CEILINGS.read_text())
    assert f"- {now['since']}: ceilings set" in DECISIONS.read_text(), (
        "docs/decisions.md has to say why they were set anew"
    )

    def git(*words: str) -> str:
        return subprocess.run(["git", *words], cwd=ROOT, capture_output=True, text=True, check=True).stdout

    file = CEILINGS.relative_to(ROOT).as_posix()
    for commit in git("log", "--max-count=30", "--format=%h", "--", file).split():
        then = tomllib.loads(git("show", f"{commit}:{file}"))
        if then["since"] == now["since"]:
            wrong = [
                f"{part}: {kind} was {then['ceilings'].get(part, {}).get(kind, 0)} in {commit}"
                for part, size in now["ceilings"].items()
                for kind in WORDS
                if size[kind] > then["ceilings"].get(part, {}).get(kind, 0)
            ]
            assert not wrong, "\n".join(["use [[raised]]:", *wrong])


TEXT = cases(__file__, "TEXT")


def test_lines_that_are_not_logic_are_not_counted() -> None:
    module = module_of(TEXT)
    assert module.logic == 4
    assert module.names == ("Thing", "_hidden")
    assert module.foreign == {"_of_a", "_exit"}


def test_rows_that_compute_are_a_program() -> None:
    assert module_of("ROWS = (1, 2)\n").logic == 0
    assert module_of("ROWS = [n for n in range(3)]\n").logic == 1
    assert module_of("ROWS = (lambda: 1, 2)\n").logic == 1


def test_a_name_that_another_file_uses_is_public() -> None:
    here = Path("autograder/kit/a.py"), module_of("import x\ndef _a(): return x._a\ndef _b(): pass\n")
    there = Path("autograder/cli/b.py"), module_of("from kit.a import _b\n")
    assert sizes(dict([here, there]))["autograder/kit"] == {"logic": 2, "public": 1}


def test_who_has_grown_is_named() -> None:
    short, long = module_of("a = 1\n"), module_of("a = 1\nb = 2\n")
    kit, cli = Path("autograder/kit/a.py"), Path("autograder/cli/b.py")
    gone, new = Path("autograder/kit/gone.py"), Path("autograder/kit/new.py")
    lines = growth({kit: short, cli: short, gone: long}, {kit: long, cli: short, new: short})
    assert lines == [
        "autograder/kit: 3 logic lines before, 3 now (+0)",
        f"       +1 {kit}",
        f"       +1 {new}",
        f"       -2 {gone}",
    ]


def test_the_files_of_a_commit_are_those_that_it_had() -> None:
    files = files_at("HEAD")
    listed = subprocess.run(
        ["git", "ls-tree", "-r", "--name-only", "HEAD", "autograder/kit"],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=True,
    ).stdout.split()
    of_the_kit = {path.as_posix() for path in files if part_of(path) == "autograder/kit"}
    assert of_the_kit == {path for path in listed if path.endswith(".py")}


def test_parts_are_folders() -> None:
    paths = ("autograder/grading/running/x.py", "autograder/course.py", "solutions/01/lab/x.py")
    assert [part_of(Path(path)) for path in paths] == ["autograder/grading", "autograder", "solutions"]


@pytest.mark.parametrize(("logic", "raised", "said"), cases(__file__, "a_ceiling_only_falls"))
def test_a_ceiling_only_falls(logic: int, raised: dict[str, Any], said: str) -> None:
    more = [{"part": "kit", **raised}] if raised else []
    data = {"since": "", "ceilings": {"kit": {"logic": 100, "public": 1}}, "raised": more}
    wrong = wrong_ceilings({"kit": Counter(logic=logic, public=1)}, data, "| 2026-12-01: more | … |")
    assert said in "".join(wrong)
    assert bool(wrong) == bool(said)
    kept = tomllib.loads(lowered({"kit": Counter(logic=logic, public=1)}, data))
    assert kept["ceilings"]["kit"]["logic"] == min(logic - raised.get("logic", 0), 100)
    assert kept.get("raised", []) == more
