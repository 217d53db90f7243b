from __future__ import annotations

import base64
import re
from typing import Any

import nbformat
import pytest
from nbconvert.filters.ansi import ansi2html

from autograder.execution.executed_cells import OUTPUT_BYTES, Budget, NotebookOutputs, OutputCollector


def collector(cell: int = 10_000, notebook: int = 100_000) -> OutputCollector:
    return OutputCollector(cell, Budget(notebook))


def test_joins_pieces_of_one_stream_and_keeps_the_order_of_two() -> None:
    collected = collector()
    for name, text in (("stdout", "a"), ("stdout", "b\n"), ("stderr", "oh"), ("stdout", "c")):
        collected.handle("stream", {"name": name, "text": text})
    assert [(o["name"], o["text"]) for o in collected.outputs()] == [
        ("stdout", "ab\n"),
        ("stderr", "oh"),
        ("stdout", "c"),
    ]


def test_keeps_no_more_than_the_cell_may_have_and_says_so() -> None:
    collected = collector(cell=10)
    collected.handle("stream", {"name": "stdout", "text": "x" * 25})
    kept, note = collected.outputs()
    assert kept["text"] == "x" * 10
    assert "15 bytes of output were dropped" in note["text"]


def test_a_talkative_cell_leaves_nothing_for_the_next_once_the_notebook_is_full() -> None:
    budget = Budget(12)
    first, second = OutputCollector(10, budget), OutputCollector(10, budget)
    first.handle("stream", {"name": "stdout", "text": "x" * 20})
    second.handle("stream", {"name": "stdout", "text": "y" * 20})
    assert second.outputs()[0]["text"] == "yy"


@pytest.mark.parametrize(
    ("message_type", "content"),
    [
        ("display_data", {"data": {"text/plain": ""}}),
        ("execute_result", {"data": {"text/plain": ""}}),
        ("error", {"ename": "x" * 200, "evalue": "", "traceback": [""] * 200}),
    ],
)
def test_a_million_outputs_with_nothing_in_them_do_not_fill_the_memory(
    message_type: str, content: dict[str, Any]
) -> None:
    collected = collector()
    for _ in range(1000):
        collected.handle(message_type, content)
    *kept, note = collected.outputs()
    _, *others = kept
    lines = sum(1 + len(output.get("traceback", ())) for output in others)
    assert 0 < lines <= 10_000 / OUTPUT_BYTES
    assert "were dropped" in note["text"]


def test_an_update_of_many_displays_at_once_counts_for_each() -> None:
    # They go through all of them: a million updates of a million displays kept the grader busy for days.
    collected = collector()
    for _ in range(100):
        collected.handle("display_data", {"data": {"text/plain": ""}, "transient": {"display_id": "same"}})
    for number in range(3):
        text = {"data": {"text/plain": str(number)}, "transient": {"display_id": "same"}}
        collected.handle("update_display_data", text)
    assert {o["data"]["text/plain"] for o in collected.outputs() if "data" in o} == {"1"}


def test_the_error_that_ends_a_cell_is_kept_whatever_was_printed_before() -> None:
    collected = collector(cell=10)
    collected.handle("stream", {"name": "stdout", "text": "x" * 1000})
    for _ in range(3):
        collected.handle("error", {"ename": "ValueError", "evalue": "v", "traceback": []})
    assert [o.get("ename") for o in collected.outputs()].count("ValueError") == 1


def test_keeps_a_bitmap_whole_or_not_at_all() -> None:
    picture = base64.b64encode(b"p" * 60).decode()
    roomy, tight = collector(), collector(cell=40)
    for collected in (roomy, tight):
        collected.handle("display_data", {"data": {"image/png": picture, "text/plain": "fig"}})
    assert roomy.outputs()[0]["data"]["image/png"] == picture
    assert "image/png" not in tight.outputs()[0]["data"]


def test_markup_is_dropped_whatever_it_looks_like_and_its_plain_twin_stays() -> None:
    collected = collector()
    script = '"><script>alert(1)</script>'
    for mime in ("text/html", "image/svg+xml", "text/markdown", "application/javascript", "text/latex"):
        for text in ("Zm9v", script):
            collected.handle("display_data", {"data": {mime: text, "text/plain": "twin"}})
    collected.handle("display_data", {"data": {"image/png": script, "text/plain": "twin"}})
    assert [output["data"] for output in collected.outputs()] == [{"text/plain": "twin"}] * 11


def test_a_progress_bar_shows_its_last_state() -> None:
    collected = collector()
    collected.handle("stream", {"name": "stdout", "text": "10 %\r50 %\r100 %\nready\r\n"})
    assert collected.outputs()[0]["text"] == "100 %\nready\n"


def test_clear_output_now_and_at_the_next_output() -> None:
    collected = collector()
    collected.handle("stream", {"name": "stdout", "text": "old"})
    collected.handle("clear_output", {"wait": True})
    assert collected.outputs()[0]["text"] == "old"
    collected.handle("stream", {"name": "stdout", "text": "new"})
    assert [o["text"] for o in collected.outputs()] == ["new"]
    collected.handle("clear_output", {"wait": False})
    assert collected.outputs() == ()


def test_a_display_is_updated_in_place() -> None:
    collected = collector()
    collected.handle("display_data", {"data": {"text/plain": "1"}, "transient": {"display_id": "d"}})
    collected.handle("update_display_data", {"data": {"text/plain": "2"}, "transient": {"display_id": "d"}})
    assert [o["data"]["text/plain"] for o in collected.outputs()] == ["2"]


ANYTHING: tuple[Any, ...] = (
    None,
    3,
    {},
    [],
    ["a", "b"],
    {"a": 1},
    "a",
    "\ud800",
    base64.b64encode(b"p").decode(),
)


@pytest.mark.parametrize("field", ANYTHING, ids=repr)
@pytest.mark.parametrize("kind", ["stream", "display_data", "execute_result", "error"])
def test_outputs_are_valid_whatever_the_form_of_the_messages(kind: str, field: Any) -> None:
    """A notebook is made of the outputs, and their form is not checked there."""
    collected = collector()
    data = {"text/plain": field, "image/png": field, "text/html": field}
    for content in (
        {},
        {"name": field, "text": field, "ename": field, "evalue": field, "traceback": field, "data": field},
        {"text": "a", "traceback": [field], "data": data, "metadata": field, "execution_count": field},
        {"data": data, "output_type": field, "other": field, "transient": field},
        {"data": data, "metadata": data, "transient": {"display_id": field}},
    ):
        collected.handle(kind, content)
        collected.handle("update_display_data", content)
    assert collected.outputs()
    for output in collected.outputs():
        assert output["output_type"] == kind
        nbformat.validate(output, ref=kind, version=4)
    assert all(isinstance(text, str) for text in all_texts(collected))
    for unknown in ("?", "clear_output"):
        collected.handle(unknown, {"data": data})
    assert collected.outputs() == ()


def test_a_lone_surrogate_becomes_writable_text() -> None:
    collected = collector()
    collected.handle("stream", {"name": "stdout", "text": "a\ud800b"})
    assert collected.outputs()[0]["text"].encode("utf-8") == b"a?b"


COLOURFUL = "\x1b[1;4;7;38;2;111;222;133;48;2;144;155;166m" + "x\x1b[1m" * 40_000


@pytest.mark.parametrize(
    ("message_type", "content"),
    [
        ("stream", {"name": "stdout", "text": COLOURFUL}),
        ("display_data", {"data": {"text/plain": COLOURFUL}}),
        ("error", {"ename": "a", "evalue": "b", "traceback": [COLOURFUL]}),
    ],
)
def test_colors_never_make_a_page_many_times_as_long_as_the_output(
    message_type: str, content: dict[str, Any]
) -> None:
    # Forty million characters of HTML were made of two million that were printed.
    collected = collector(cell=200_000, notebook=2_000_000)
    collected.handle(message_type, content)
    for _ in range(20):
        collected.handle(message_type, {**content, "text": COLOURFUL[:100]})
    assert len(ansi2html("".join(all_texts(collected)))) < 5 * 200_000


@pytest.mark.parametrize("middle", ["", "\x1b[" + ";" * 50 + "m", "\x1b", "\x1b["])
def test_a_color_code_without_end_is_none(middle: str) -> None:
    # nbconvert's filter took two seconds for one of 200,000 characters, and a notebook may have ten of them.
    collected = collector(cell=200_000, notebook=2_000_000)
    collected.handle("stream", {"name": "stdout", "text": f"a\x1b[;;;{middle}{';' * 90_000}mb"})
    (text,) = all_texts(collected)
    assert max(map(len, re.findall(r"\x1b\[(.*?)[@-~]", text)), default=0) <= 40
    assert text.startswith("a")
    assert text.endswith("b")


def test_the_usual_colors_stay_also_when_outputs_are_cut_again() -> None:
    text = "\x1b[31mred\x1b[0m and \x1b[38;5;28;01mgreen\x1b[39;00m"
    cut_again = NotebookOutputs(1, 10_000, 100_000)
    collected = collector()
    for _ in range(1_000):
        collected.handle("stream", {"name": "stdout", "text": text})
    cut_again.put(0, collected.outputs())
    once, twice = (
        "".join(one["text"] for one in outputs) for outputs in (collected.outputs(), cut_again.of(0))
    )
    is_same = once == twice  # a comparison of long texts by pytest would take minutes
    assert is_same
    assert once.startswith(text)


def all_texts(collected: OutputCollector) -> list[str]:
    outputs = collected.outputs()
    return [
        piece
        for output in outputs
        for piece in (
            output.get("text", ""),
            output.get("data", {}).get("text/plain", ""),
            *output.get("traceback", ()),
        )
        if piece and "were dropped" not in piece
    ]
