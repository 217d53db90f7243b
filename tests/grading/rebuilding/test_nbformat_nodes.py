"""Nodes made without nbformat's validation are what nbformat would have made."""

from __future__ import annotations

import json
from typing import Any

import msgspec
import nbformat
import pytest

from autograder.execution.executed_cells import Budget, CellType, OutputCollector
from autograder.grading.rebuilding import nbformat_nodes

_new_output: Any = nbformat.v4.new_output
_PICTURE = "iVBORw0KGgo="


def collected() -> list[dict[str, Any]]:
    """An output of each kind that a box hands over, made by what makes them there."""
    collector = OutputCollector(10_000, Budget(10_000))
    rich = {"data": {"text/plain": "1", "image/png": _PICTURE, "text/html": "<script>"}, "metadata": {"a": 1}}
    collector.handle("stream", {"name": "stderr", "text": "é\nb\n"})
    collector.handle("display_data", rich)
    collector.handle("execute_result", {**rich, "execution_count": 3})
    collector.handle("error", {"ename": "E", "evalue": "v", "traceback": ["\x1b[0ma", "b"]})
    return list(collector.outputs())


@pytest.mark.parametrize("fields", collected(), ids=lambda fields: fields["output_type"])
def test_an_output_is_the_one_that_nbformat_makes(fields: dict[str, Any]) -> None:
    made = nbformat_nodes.output(**fields)
    expected = _new_output(**fields)
    assert made == expected
    assert type(made) is type(expected)
    assert type(made.get("data")) is type(expected.get("data"))


def whole() -> Any:
    cells = [nbformat_nodes.cell(kind, f"{kind}\n\ntwo lines") for kind in CellType]
    cells[0]["outputs"] = [nbformat_nodes.output(**fields) for fields in collected()]
    cells[1].metadata["nbgrader"] = {"grade_id": "a", "points": 1.0, "solution": False}
    return nbformat_nodes.notebook(cells, {"autograder": {"remarks": ["one", "two"]}})


def test_what_was_written_is_read_as_nbformat_reads_it() -> None:
    text = nbformat_nodes.text(whole())  # this one validates
    read = nbformat_nodes.read_own(text.encode())
    assert read == nbformat_nodes.read(text) == whole() | {"cells": read.cells}
    assert read.cells[0].outputs[0].text == "é\nb\n"
    assert read.cells[1].metadata.nbgrader.grade_id == "a"
    with pytest.raises(msgspec.DecodeError):
        nbformat_nodes.read_own(b"{")


def test_a_copy_shares_nothing_that_can_be_changed() -> None:
    original = whole()
    before = json.dumps(original)
    copy = nbformat_nodes.copied(original)
    assert copy == original
    copy.cells[0].outputs[1].data["text/plain"] = "other"
    copy.cells[0].outputs[3].traceback.append("other")
    copy.cells[1].metadata.nbgrader.points = 5
    copy.metadata.autograder.remarks.append("three")
    copy.cells.pop()
    assert json.dumps(original) == before


def test_an_id_is_the_given_one_or_none_that_was_there_before() -> None:
    assert nbformat_nodes.cell(CellType.CODE, "", "own").id == "own"
    assert len({nbformat_nodes.cell(CellType.CODE, "").id for _ in range(100)}) == 100
