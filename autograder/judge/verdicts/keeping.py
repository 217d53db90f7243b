"""Pack the evidence of a check into bytes of limited size, and unpack it unchanged.

The format is JSON, compressed with gzip, with one line for each event. Evidence that is too long is cut and marked as
cut, because no verdict may be derived from a part of it.
"""

from __future__ import annotations

import json
import math
import time
import traceback
import zlib
from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import msgspec

from autograder.judge.verdicts import reference
from autograder.kit.evidence import Evidence, Part
from autograder.verdict import Verdict  # noqa: TC001  (msgspec reads the annotations)

if TYPE_CHECKING:
    from collections.abc import Sequence

    from autograder.judge.verdicts.trial import Checked
    from autograder.kit.evidence import Reference

MAX_BYTES = 400_000
"""The maximum size of the evidence of one check, in compressed bytes."""
MAX_RAW_BYTES = 8_000_000
"""The maximum size in bytes before compression. Without it, evidence full of repetitions could be huge, because it is
small after compression.
"""
_GZIP = 31
"""The value of zlib's ``wbits`` for a gzip header with the largest window."""
_FLOAT = "$float"
"""The key of a dictionary that stands for a number that JSON cannot express, such as infinity. No field of a ROS
message can have this name.
"""


class NoEvidence(ValueError):
    """The bytes are not evidence, for the reason in the exception's text."""


class KeptLook(msgspec.Struct, frozen=True):
    """The evidence of one look, that is, of one run of the scenario."""

    real_time: bool
    parts: list[Part]


class Kept(msgspec.Struct, frozen=True):
    """A verdict with the evidence from which it is derived.

    Attributes:
        at: Unix time of the verdict, in seconds.
        reference: The SHA-256 of the reference output's file.
        verdict: The verdict without its timeline, which is derived from the events.
        looks: The fast look, and the look in real time if there was one.
        cut: A text that says which lines are missing, and why; empty if the evidence is complete.
    """

    at: float
    reference: str
    verdict: Verdict
    looks: list[KeptLook]
    cut: str = ""


def packed(checked: Checked) -> bytes:
    """Pack the evidence of a check. If packing fails, return no bytes, so that the student still gets the verdict."""
    try:
        digest = reference.digest(checked.verdict.exercise)
        return pack(checked.verdict, checked.evidence, digest, at=time.time())
    except Exception:
        traceback.print_exc()
        return b""


def pack(verdict: Verdict, evidence: Evidence, digest: str, *, at: float) -> bytes:
    """Pack a verdict and its evidence into bytes that :func:`unpack` can read.

    Args:
        verdict: The verdict.
        evidence: The evidence for it.
        digest: The SHA-256 of the reference output.
        at: Unix time of the verdict, in seconds.
    """
    looks = [look for look in (evidence.before, evidence) if look is not None]
    sheet = _Sheet()
    told = msgspec.to_builtins(replace(verdict, timeline=()))
    sheet.write({"at": at, "reference": digest, "verdict": told})
    for look in looks:
        sheet.write({"real_time": look.real_time})
        for part in look:
            sheet.write({"name": part.name, "inputs": part.inputs})
            for event in part.events:
                sheet.write([event.t, event.kind, event.name, event.data, event.sim])
    cut = ""
    if sheet.left_out:
        cut = (
            f"the last {sheet.left_out} of {sheet.lines} lines are missing: the evidence of one check is limited to "
            f"{MAX_RAW_BYTES} bytes, and to {MAX_BYTES} bytes after compression"
        )
    return sheet.end({"cut": cut})


class _Sheet:
    """Collects lines of JSON, compressed with gzip, up to the size limits."""

    def __init__(self) -> None:
        self._zip = zlib.compressobj(1, zlib.DEFLATED, _GZIP)
        self._written = bytearray()
        self._pending = self._raw = 0
        self.lines = self.left_out = 0

    def write(self, row: Any) -> None:
        """Add a line. Leave it out if this line or an earlier line exceeds the limits."""
        self.lines += 1
        if self.left_out or not self._add(_line(row)):
            self.left_out += 1

    def end(self, row: Any) -> bytes:
        """Add a last line, even beyond the limits, and return all compressed bytes."""
        return bytes(self._written) + self._zip.compress(_line(row)) + self._zip.flush()

    def _add(self, line: bytes) -> bool:
        # Lines inside the compressor count with their uncompressed size until a flush shows the compressed size.
        if len(self._written) + self._pending + len(line) > MAX_BYTES:
            self._written += self._zip.flush(zlib.Z_SYNC_FLUSH)
            self._pending = 0
        self._raw += len(line)
        if self._raw > MAX_RAW_BYTES or len(self._written) + self._pending + len(line) > MAX_BYTES:
            return False
        self._written += self._zip.compress(line)
        self._pending += len(line)
        return True


def unpack(data: bytes) -> Kept:
    """Unpack what :func:`pack` has packed.

    Raises:
        NoEvidence: The bytes are not evidence, or are damaged.
    """
    try:
        unzip = zlib.decompressobj(_GZIP)
        text = unzip.decompress(data, 2 * MAX_RAW_BYTES)
        if not unzip.eof:
            raise NoEvidence("the end of the evidence is missing, or the evidence is larger than allowed")
        first, *rows, last = [restored(json.loads(line)) for line in text.splitlines()]
        return msgspec.convert({**first, **last, "looks": _looks(rows)}, type=Kept)
    except (zlib.error, ValueError, TypeError, LookupError, RecursionError) as error:
        raise error if isinstance(error, NoEvidence) else NoEvidence(str(error)) from error


def _looks(rows: Sequence[Any]) -> list[dict[str, Any]]:
    looks: list[dict[str, Any]] = []
    for row in rows:
        if isinstance(row, list):
            looks[-1]["parts"][-1]["events"].append(
                dict(zip(("t", "kind", "name", "data", "sim"), row, strict=True))
            )
        elif "real_time" in row:
            looks.append({**row, "parts": []})
        else:
            looks[-1]["parts"].append({**row, "events": []})
    return looks


def evidence_of(kept: Kept, expected: Reference) -> Evidence:
    """Return unpacked evidence in the form from which the judge derives verdicts.

    Args:
        kept: The unpacked verdict and evidence.
        expected: The reference output.

    Raises:
        NoEvidence: The evidence contains no look.
    """
    evidence: Evidence | None = None
    for look in kept.looks:
        evidence = Evidence(look.parts, expected, look.real_time, evidence)
    if evidence is None:
        raise NoEvidence("the judge saw nothing")
    return evidence


def _line(row: Any) -> bytes:
    try:
        text = json.dumps(row, allow_nan=False)
    except (ValueError, TypeError):
        text = json.dumps(plain(row))
    return text.encode() + b"\n"


def plain(value: Any) -> Any:
    """Return a value that JSON can express: infinity becomes ``{"$float": "inf"}``, and other objects become text."""
    if isinstance(value, float) and not math.isfinite(value):
        return {_FLOAT: str(value)}
    if isinstance(value, Mapping):
        return {str(key): plain(inner) for key, inner in value.items()}
    if isinstance(value, (list, tuple)):
        return [plain(inner) for inner in value]
    return value if isinstance(value, (str, int, float)) or value is None else repr(value)


def restored(value: Any) -> Any:
    """Undo :func:`plain` for numbers such as infinity."""
    if isinstance(value, dict):
        if value.keys() == {_FLOAT}:
            return float(value[_FLOAT])
        return {key: restored(inner) for key, inner in value.items()}
    return [restored(inner) for inner in value] if isinstance(value, list) else value
