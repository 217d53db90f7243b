"""Cells that are executed: their input and results, as plain data that is sent as JSON, and their outputs.

Outputs are collected in bounded memory, whatever the kernel sends. Messages come from the student's process and are
never trusted. A message that breaks the Jupyter messaging specification is dropped. Of rich output only plain text and
bitmaps are kept, because HTML, SVG, JavaScript and Markdown would be rendered in the browser of everyone who reads the
feedback.
"""

from __future__ import annotations

import base64
import binascii
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Any

import re2

from autograder.boxes.run_limits import Ended  # noqa: TC001  (msgspec reads the annotations)
from autograder.verdict import Verdict  # noqa: TC001  (msgspec reads the annotations)


class CellType(StrEnum):
    """The type of a cell, with nbformat's names."""

    CODE = "code"
    MARKDOWN = "markdown"
    RAW = "raw"


@dataclass(frozen=True)
class CellCheck:
    """The check that a check cell requests.

    Attributes:
        exercise: The exercise's id, such as ``"lab_1_2.talker"``.
        title: The exercise's title for people.
        points: The maximum points that the judge gives.
        worth: The cell's maximum points in the gradebook. The judge's score is scaled to them.
        limit: The judge's time limit in seconds of wall time.
        asserts: True if the cell's own tests decide, by nbgrader's rules, and not the judge.
    """

    exercise: str
    title: str
    points: float
    worth: float
    limit: float
    asserts: bool = False


@dataclass(frozen=True)
class Cell:
    """A cell to execute.

    Attributes:
        source: The text of the cell.
        kind: The type of the cell. Only code cells are executed.
        check: The check, if this is a check cell.
        name: The grade_id of the cell; empty for a cell that the student added.
        own: True if a student wrote the text.
    """

    source: str
    kind: CellType = CellType.CODE
    check: CellCheck | None = None
    name: str = ""
    own: bool = False


@dataclass(frozen=True)
class CellRun:
    """The result of one cell.

    Attributes:
        ended: How the execution of the cell ended.
        outputs: Outputs in nbformat's form, limited in size and without anything that a browser would execute.
        error: For a cell that raised an error, a text such as ``"NameError: name 'x' is not defined"``, else empty.
            The text comes from the student's code.
        seconds: The duration in seconds of wall time.
    """

    ended: Ended
    outputs: tuple[dict[str, Any], ...] = ()
    error: str = ""
    seconds: float = 0.0


@dataclass(frozen=True)
class Execution:
    """The result of executing a notebook.

    Attributes:
        cells: The results of the cells that were given, in the same order.
        verdicts: The verdicts by the index of the check cell. Every check cell has one.
        trouble: A failure of the grader itself; empty if there was none. With such a failure, no result is final.
        seconds: The duration in seconds of wall time, including the start of the kernel.
        start_seconds: The part of ``seconds`` until kernel and judge were ready.
        crowded_out: True if the notebook may have failed only because other work ran at the same time.
        cpu_seconds: The processor time in seconds that was used in the student's boxes; 0 if it is not counted.
        evidence: The evidence for the judge's verdicts, by exercise, packed. Grading does not unpack it.
    """

    cells: tuple[CellRun, ...]
    verdicts: dict[int, Verdict] = field(default_factory=dict)
    trouble: str = ""
    seconds: float = 0.0
    start_seconds: float = 0.0
    crowded_out: bool = False
    cpu_seconds: float = 0.0
    evidence: dict[str, bytes] = field(default_factory=dict)

    @property
    def should_retry_alone(self) -> bool:
        """True if the notebook should run again, alone: the grader failed, or other work may have used up resources."""
        return bool(self.trouble) or self.crowded_out


IMAGES = ("image/png", "image/jpeg")
TRACEBACK_LINES = 200
OUTPUT_BYTES = 32
"""The minimum number of bytes that is counted for an output, an update or a line of a traceback. Otherwise a million
empty ones would stay below the limit, but fill the memory and take long to render.
"""

_ESCAPE, _COLOR = "\x1b", "\x1b["
_COLOR_BYTES = 32
"""The number of bytes that a color code counts in addition to its length, because a page needs an HTML element of about
130 characters for the text after each code.
"""
_COLORS = re2.compile(r"\x1b\[[^@-~\n]*[@-~]?")
_LONG_COLOR = re2.compile(r"\x1b\[[^@-~\n]{41,}[@-~]?")
"""Matches a color code that is longer than any in use. nbconvert takes quadratic time for the numbers in a code."""
_NO_COLOR = "\x1b[m"
"""The shortest color code, which replaces long ones. Its ``[`` ends an unfinished code in front of it, so that the two
do not form a new long code.
"""


class Budget:
    """The bytes of output that may still be kept, over several cells."""

    def __init__(self, total: int) -> None:
        self.left = total

    def take(self, wanted: int) -> int:
        """Use at most ``wanted`` bytes of the budget. Return how many were used."""
        granted = max(0, min(wanted, self.left))
        self.left -= granted
        return granted


class OutputCollector:
    """The outputs of one cell.

    Args:
        cell_bytes: The maximum number of bytes to keep for this cell.
        notebook: The budget of the whole notebook.
    """

    def __init__(self, cell_bytes: int, notebook: Budget) -> None:
        self._own = Budget(cell_bytes)
        self._notebook = notebook
        self._outputs: list[dict[str, Any]] = []
        self._displays: dict[str, list[dict[str, Any]]] = {}
        self._clear_at_next = False
        self._dropped = 0

    def handle(self, message_type: str, content: Mapping[str, Any]) -> None:
        """Process one iopub message; messages that are not outputs are ignored."""
        match message_type:
            case "stream":
                self._stream(content)
            case "display_data" | "execute_result":
                self._display(message_type, content)
            case "update_display_data":
                self._update(content)
            case "error":
                self._error(content)
            case "clear_output":
                if content.get("wait"):
                    self._clear_at_next = True
                else:
                    self._clear()

    def outputs(self) -> tuple[dict[str, Any], ...]:
        """The outputs so far in nbformat's format, with a last line if anything was dropped."""
        outputs = [_without_overwritten_lines(output) for output in self._outputs]
        if self._dropped:
            outputs.append(
                {
                    "output_type": "stream",
                    "name": "stdout",
                    "text": f"\n[{self._dropped} bytes of output were dropped]\n",
                }
            )
        return tuple(outputs)

    def _stream(self, content: Mapping[str, Any]) -> None:
        name = "stderr" if content.get("name") == "stderr" else "stdout"
        text = _text(content.get("text"))
        goes_on = not self._clear_at_next and bool(self._outputs) and self._outputs[-1].get("name") == name
        if text and not goes_on and not self._has_room():
            self._dropped += len(text.encode())
            return
        text = self._afford(text)
        if not text:
            return
        self._clear_if_due()
        if goes_on:
            # Pieces are joined later, because repeated += on a long string would take quadratic time.
            self._outputs[-1]["text"].append(text)
        else:
            self._outputs.append({"output_type": "stream", "name": name, "text": [text]})

    def _display(self, message_type: str, content: Mapping[str, Any]) -> None:
        data = self._safe_data(content.get("data"))
        if not data or not self._has_room():
            return
        self._clear_if_due()
        output: dict[str, Any] = {"output_type": message_type, "data": data, "metadata": {}}
        if message_type == "execute_result":
            output["execution_count"] = None
        self._outputs.append(output)
        display_id = _display_id(content)
        if display_id:
            self._displays.setdefault(display_id, []).append(output)

    def _update(self, content: Mapping[str, Any]) -> None:
        earlier = self._displays.get(_display_id(content), [])
        data = self._safe_data(content.get("data")) if earlier else {}
        if data and self._has_room(len(earlier)):
            for output in earlier:
                output["data"] = data

    def _error(self, content: Mapping[str, Any]) -> None:
        # One error is always kept, because it explains why the cell ended.
        if not self._has_room() and any(output["output_type"] == "error" for output in self._outputs[-1:]):
            return
        self._clear_if_due()
        lines = content.get("traceback")
        lines = lines[:TRACEBACK_LINES] if isinstance(lines, list) else []
        traceback = [self._afford(_text(line)) for line in lines if self._has_room()]
        self._outputs.append(
            {
                "output_type": "error",
                "ename": _text(content.get("ename"))[:200],
                "evalue": self._afford(_text(content.get("evalue"))),
                "traceback": traceback,
            }
        )

    def _safe_data(self, data: Any) -> dict[str, str]:
        if not isinstance(data, Mapping):
            return {}
        safe: dict[str, str] = {}
        for mime in IMAGES:
            picture = data.get(mime)
            if isinstance(picture, str) and _is_base64(picture):
                # Half a picture is useless, so keep all of it or nothing.
                if len(picture) <= min(self._own.left, self._notebook.left):
                    safe[mime] = self._afford(picture)
                else:
                    self._dropped += len(picture)
        if "text/plain" in data:
            safe["text/plain"] = self._afford(_text(data["text/plain"]))
        return safe

    def _has_room(self, outputs: int = 1) -> bool:
        """Subtract the minimum size of these outputs from the budgets. Return True if enough was left.

        Nothing is subtracted for the first output of a cell.
        """
        size = outputs * OUTPUT_BYTES if self._outputs and not self._clear_at_next else 0
        if self._notebook.take(self._own.take(size)) == size:
            return True
        self._dropped += size
        return False

    def _afford(self, text: str) -> str:
        if _COLOR in text:
            text = self._afford_colors(_LONG_COLOR.sub(_NO_COLOR, text))
        size = len(text.encode())
        granted = self._notebook.take(self._own.take(size))
        if granted == size:
            return text
        self._dropped += size - granted
        return text.encode()[:granted].decode(errors="ignore")

    def _afford_colors(self, text: str) -> str:
        """Subtract the color codes of a text from the budgets. Return the text; without colors if they are too many."""
        left = min(self._own.left, self._notebook.left)
        wanted = _COLOR_BYTES * text.count(_COLOR)
        if wanted + len(text.encode()) > left:
            # Search only the part that may be kept, because a search takes long. Subtract also what is removed from it.
            plain, rest = _COLORS.sub("", text[:left]).replace(_ESCAPE, ""), text[left:]
            wanted, text = min(left, len(text)) - len(plain), plain + rest.replace(_ESCAPE, "")
        self._notebook.take(self._own.take(wanted))
        return text

    def _clear_if_due(self) -> None:
        if self._clear_at_next:
            self._clear()

    def _clear(self) -> None:
        self._outputs.clear()
        self._displays.clear()
        self._clear_at_next = False


_CLOSING_LINE = 200
"""The maximum number of bytes that a desk itself adds to an output that it had to cut."""


class NotebookOutputs:
    """The outputs of a notebook's cells, as a desk reports them. They are cut and cleaned again here.

    Args:
        cells: The number of cells.
        cell_bytes: The maximum number of bytes that the process may report for a cell.
        notebook_bytes: The maximum number of bytes that the process may report for all cells together.
    """

    def __init__(self, cells: int, cell_bytes: int, notebook_bytes: int) -> None:
        self._cell_bytes = cell_bytes + _CLOSING_LINE
        self._budget = Budget(notebook_bytes + _CLOSING_LINE * cells)
        self._used = [0] * cells
        self._outputs: list[tuple[dict[str, Any], ...]] = [()] * cells

    def put(self, cell: int, outputs: Iterable[Mapping[str, Any]]) -> None:
        """Replace the outputs of a cell."""
        self._budget.left += self._used[cell]
        before = self._budget.left
        collector = OutputCollector(self._cell_bytes, self._budget)
        for output in outputs:
            collector.handle(str(output.get("output_type")), output)
        self._used[cell] = before - self._budget.left
        self._outputs[cell] = collector.outputs()

    def of(self, cell: int) -> tuple[dict[str, Any], ...]:
        """Return the outputs of a cell in nbformat's format."""
        return self._outputs[cell]


def _text(value: Any) -> str:
    """Return ``value`` as text that UTF-8 can encode; a lone surrogate would stop the conversion of the notebook."""
    text = value if isinstance(value, str) else "" if value is None else repr(value)[:1000]
    return text.encode("utf-8", "replace").decode("utf-8")


def _display_id(content: Mapping[str, Any]) -> str:
    transient = content.get("transient")
    return _text(transient.get("display_id")) if isinstance(transient, Mapping) else ""


def _is_base64(text: str) -> bool:
    try:
        base64.b64decode("".join(text.split()), validate=True)
    except (binascii.Error, ValueError):
        return False
    return True


def _without_overwritten_lines(output: dict[str, Any]) -> dict[str, Any]:
    """Join a stream's pieces. If carriage returns overwrite a line, keep the text that a terminal would show."""
    if output["output_type"] != "stream":
        return output
    lines = "".join(output["text"]).replace("\r\n", "\n").split("\n")
    return {**output, "text": "\n".join(line.rstrip("\r").rpartition("\r")[2] for line in lines)}
