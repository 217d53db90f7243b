"""Code that drives a subject counts for the evidence of its answers, and words do not."""

from __future__ import annotations

import importlib.util
import sys
from typing import TYPE_CHECKING

import pytest

from tests.cases import cases
from tests.measure import driving_code
from tests.measure.stimulus import without_texts

if TYPE_CHECKING:
    from pathlib import Path

SCENARIO = cases(__file__, "SCENARIO")


def reached(text: str, folder: Path, module_name: str = "autograder.kit.made_up") -> list[str]:
    file = folder / f"made_up_{len(list(folder.iterdir()))}.py"  # no bytecode of another one is taken for it
    file.write_text(text, encoding="utf-8")
    spec = importlib.util.spec_from_file_location(module_name, file)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    with pytest.MonkeyPatch.context() as patch:
        patch.setitem(sys.modules, spec.name, module)
        spec.loader.exec_module(module)
        code = driving_code.DrivingCode()
        code.add(module.scenario)
        return code.texts()


@pytest.mark.parametrize(("old", "new"), cases(__file__, "what_drives_a_subject_counts"))
def test_what_drives_a_subject_counts(old: str, new: str, tmp_path: Path) -> None:
    assert old in SCENARIO
    assert reached(SCENARIO.replace(old, new), tmp_path) != reached(SCENARIO, tmp_path)


@pytest.mark.parametrize(("old", "new"), cases(__file__, "words_do_not_count"))
def test_words_do_not_count(old: str, new: str, tmp_path: Path) -> None:
    assert old in SCENARIO
    assert reached(SCENARIO.replace(old, new), tmp_path) == reached(SCENARIO, tmp_path)


def test_where_a_scenario_is_written_does_not_count(tmp_path: Path) -> None:
    assert reached(SCENARIO, tmp_path) == reached(SCENARIO, tmp_path, "autograder.kit.recipes.moved")


def test_of_a_reference_output_the_texts_do_not_count() -> None:
    noted = {
        "kind": "noted",
        "name": "/a",
        "data": {"step": 1, "given": "1 s without an input", "values": [2]},
    }
    reference = {"exercise": "lab.one", "parts": [{"name": "drawing 0", "inputs": {}, "events": [noted]}]}
    card = {"key": "late", "text": "It comes late.", "next_step": "Send it at once.", "parts": []}
    assert without_texts({**reference, "variants": [card]}) == without_texts(reference)
    assert "without an input" not in str(without_texts(reference))
    assert "[2]" in str(without_texts(reference))
