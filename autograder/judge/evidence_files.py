"""Writes evidence and reads it back: reference outputs, and the packed evidence of checks.

A reference output contains the events of a reference solution on the wire, as JSON that people can review. It contains
only facts that the task determines, such as messages, requests and answers. Facts that differ from run to run are left
out, such as wall times, random node names and the order of log lines from two channels.

The evidence of a check is packed unchanged into bytes of limited size: JSON, compressed with gzip, with one line for
each event. Evidence that is too long is cut and marked as cut, because no verdict may be derived from a part of it.
"""

from __future__ import annotations

import functools
import hashlib
import json
import math
import time
import traceback
import zlib
from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import msgspec

from autograder import packed_files
from autograder.command_name import COMMAND
from autograder.exercises import mutants_path, reference_path
from autograder.kit.evidence import Event, Evidence, Part, Reference, Variant
from autograder.kit.oracle.naming.deltas import Mutants
from autograder.verdict import Verdict  # noqa: TC001  (msgspec reads the annotations)

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from autograder.judge.one_check import Look


_RECORDED_KINDS = (
    "message", "sent", "request", "response", "goal", "feedback", "cancel", "result", "asked", "answered",
    "goal_sent", "goal_answer", "feedback_heard", "cancel_sent", "cancel_answer", "result_heard",
    "said", "type", "noted",
)  # fmt: skip

_UNTIL_CANCELED = ("feedback_heard", "result_heard")
_VARYING_FIELDS = ("number", "sent", "arrived", "ways")
"""The fields of an event that differ from run to run, and so are not recorded."""


class NoReference(LookupError):
    """The reference output of an exercise does not exist or cannot be read."""


def load_reference(exercise_id: str, drawing: str = "", *, mutants: bool = True) -> Reference:
    """Read a reference output.

    Args:
        drawing: The recording of a drawing of a class, as JSON. Its part replaces those with the practice drawings.
        mutants: False to leave out what the mutants of the solution do.

    Raises:
        NoReference: The file does not exist, or is not a reference output.
    """
    file = reference_path(exercise_id)
    try:
        text = file.read_text(encoding="utf-8")
        stored = parse_reference(json.loads(text))
    except FileNotFoundError as error:
        raise NoReference(f"{file} does not exist: run `{COMMAND} record {exercise_id}`") from error
    except (ValueError, KeyError, TypeError) as error:
        raise NoReference(
            f"{file} is not a reference output ({error}): run `{COMMAND} record {exercise_id}`"
        ) from error
    file = mutants_path(exercise_id)
    try:
        found = _mutants(packed_files.read(file), text) if mutants and file.exists() else None
    except (OSError, EOFError, msgspec.MsgspecError) as error:
        raise NoReference(f"{file} is damaged ({error}): run `{COMMAND} record {exercise_id}`") from error
    stored = replace(stored, mutants=replace(found, solution=stored.parts) if found else None)
    return replace(stored, parts=parse_reference(json.loads(drawing)).parts) if drawing else stored


@functools.lru_cache(maxsize=16)
def _mutants(recorded: bytes, reference: str) -> Mutants | None:
    """Return what the mutants of a solution do; None if it was recorded with another text of the reference output."""
    found = msgspec.json.decode(recorded, type=Mutants)
    return found if found.reference == parts_digest(parse_reference(json.loads(reference)).parts) else None


def parts_digest(parts: Sequence[Part]) -> str:
    """Return the SHA-256 of the record of a solution, in hexadecimal; its endpoints do not count."""
    return hashlib.sha256(_parts_text(parts, None).encode()).hexdigest()


def reference_digest(exercise_id: str) -> str:
    """Return the SHA-256 of a reference output's file, in hexadecimal.

    Raises:
        NoReference: The file cannot be read.
    """
    file = reference_path(exercise_id)
    try:
        return hashlib.sha256(file.read_bytes()).hexdigest()
    except OSError as error:
        raise NoReference(f"{file} cannot be read: run `{COMMAND} record {exercise_id}`") from error


def parse_reference(data: Mapping[str, Any]) -> Reference:
    """Return a reference output from its JSON form."""
    variants = [
        Variant(one["key"], one["text"], one["next_step"], _parts(one["parts"]))
        for one in data.get("variants", ())
    ]
    return Reference(
        data["exercise"], data["interface"], _parts(data["parts"]), variants, data.get("qos", {})
    )


def _parts(listed: Sequence[Mapping[str, Any]]) -> list[Part]:
    return [
        Part(
            part["name"],
            part["inputs"],
            [
                Event(e.get("t", 0.0), e["kind"], e["name"], e.get("data", {}), e.get("sim"))
                for e in part["events"]
            ],
        )
        for part in listed
    ]


def as_recorded(reference: Reference, kinds: Sequence[str] | None) -> Reference:
    """Return a recording as it is read back: only with what is written. ``kinds`` is as for :func:`dump_reference`."""
    return parse_reference(json.loads(dump_reference(reference, kinds)))


def dump_reference(reference: Reference, kinds: Sequence[str] | None = None) -> str:
    """Return a recording as JSON, with one line for each event. Recordings of the same behavior give the same text.

    Args:
        reference: The recording.
        kinds: The kinds of events to write; None for the usual kinds.
    """
    head = {"exercise": reference.exercise, "interface": _sorted_interface(reference.interface)}
    if qos := _sorted_interface(reference.qos):
        head["qos"] = qos
    blocks = [
        json.dumps(head, indent=1, ensure_ascii=False).removesuffix("\n}"),
        f' "parts": [\n{_parts_text(reference.parts, kinds)}\n ]',
    ]
    if reference.variants:
        variants = ",\n".join(_variant_text(variant, kinds) for variant in reference.variants)
        blocks.append(f' "variants": [\n{variants}\n ]')
    return ",\n".join(blocks) + "\n}\n"


def _variant_text(variant: Variant, kinds: Sequence[str] | None) -> str:
    head = {"key": variant.key, "text": variant.text, "next_step": variant.next_step}
    told = json.dumps(head, ensure_ascii=False).removesuffix("}")
    return f'  {told}, "parts": [\n{_parts_text(variant.parts, kinds)}\n  ]}}'


def _parts_text(parts: Sequence[Part], kinds: Sequence[str] | None) -> str:
    kept = [
        part if kinds is None else replace(part, events=[e for e in part.events if e.kind in kinds])
        for part in parts
    ]
    return ",\n".join(map(_part_text, kept))


def _part_text(part: Part) -> str:
    events = ",\n".join(f"   {json.dumps(event, ensure_ascii=False)}" for event in _recorded_events(part))
    name, inputs = (json.dumps(value, ensure_ascii=False) for value in (part.name, dict(part.inputs)))
    return f'  {{"name": {name}, "inputs": {inputs}, "events": [\n{events}\n  ]}}'


def _sorted_interface(interface: Mapping[str, Mapping[str, str]]) -> dict[str, dict[str, str]]:
    return {role: dict(sorted(names.items())) for role, names in sorted(interface.items()) if names}


def _recorded_events(part: Part) -> list[dict[str, Any]]:
    kept = [event for event in part.events if event.kind in _RECORDED_KINDS]
    # Leave out the feedback and the result of a canceled goal: how far the goal gets depends on the machine.
    canceled = {event.data["goal"] for event in kept if event.kind == "cancel_sent"}
    kept = [e for e in kept if not (e.kind in _UNTIL_CANCELED and e.data["goal"] in canceled)]
    # If goals run at the same time in one part, the order of their events depends on the machine. So sort the events by
    # goal, with the answer before the feedback.
    kept.sort(key=lambda event: (event.data.get("goal", 0), event.kind not in ("goal_sent", "goal_answer")))
    start = next((event.sim for event in kept if event.sim is not None), None)
    return [_event_row(event, start) for event in kept]


def _event_row(event: Event, start: float | None) -> dict[str, Any]:
    row: dict[str, Any] = {"kind": event.kind, "name": event.name}
    # What a scenario notes is the same in each run, but the time at which it can note it is not.
    if event.sim is not None and start is not None and event.kind != "noted":
        row["sim"] = round(event.sim - start, 3)
    return row | {"data": {name: value for name, value in event.data.items() if name not in _VARYING_FIELDS}}


MAX_BYTES = 400_000
"""The maximum size of the evidence of one check, in compressed bytes."""
MAX_RAW_BYTES = 8_000_000
"""The maximum size in bytes before compression. Without it, evidence full of repetitions could be huge, because it is
small after compression.
"""
MAX_LINES_BYTES = MAX_RAW_BYTES + 1_000
"""The maximum size in bytes of all lines. The last line, about what was left out, is written beyond the limit."""
_EXPECTED = {"of": "the solution"}
"""The line above the record of the solution in the drawing that the subject was given."""
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
        expected: The record of the solution in the drawing of a class that the subject was given; empty if it was given
            a practice drawing, or the exercise has none. These are in the reference output.
        cut: A text that says which lines are missing, and why; empty if the evidence is complete.
    """

    at: float
    reference: str
    verdict: Verdict
    looks: list[KeptLook]
    cut: str = ""
    expected: list[Part] = []


def packed(checked: Look, drawn: Reference | None = None) -> bytes:
    """Pack the evidence of a check. If packing fails, return no bytes, so that the student still gets the verdict.

    Args:
        drawn: The recording of the drawing of a class that the subject was given; None if it was given none.
    """
    try:
        digest = reference_digest(checked.verdict.exercise)
        expected = drawn.parts if drawn else ()
        return pack(checked.verdict, checked.evidence, digest, at=time.time(), expected=expected)
    except Exception:
        traceback.print_exc()
        return b""


def pack(
    verdict: Verdict, evidence: Evidence, digest: str, *, at: float, expected: Sequence[Part] = ()
) -> bytes:
    """Pack a verdict and its evidence into bytes that :func:`unpack` can read.

    Args:
        digest: The SHA-256 of the reference output.
        at: Unix time of the verdict, in seconds.
        expected: As in :class:`Kept`.
    """
    looks = [look for look in (evidence.before, evidence) if look is not None]
    sheet = _Sheet()
    told = msgspec.to_builtins(replace(verdict, timeline=()))
    sheet.write({"at": at, "reference": digest, "verdict": told})
    if expected:
        sheet.write(_EXPECTED)
        sheet.write_parts(expected)
    for look in looks:
        sheet.write({"real_time": look.real_time})
        sheet.write_parts(look)
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

    def write_parts(self, parts: Iterable[Part]) -> None:
        """Add a line for each part, and below it a line for each event."""
        for part in parts:
            self.write({"name": part.name, "inputs": part.inputs})
            for event in part.events:
                self.write([event.t, event.kind, event.name, event.data, event.sim])

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
    return parse(lines_of(data))


def lines_of(data: bytes) -> bytes:
    """Return the lines of packed evidence, each of which is JSON.

    Raises:
        NoEvidence: The bytes are not evidence, or are damaged.
    """
    try:
        unzip = zlib.decompressobj(_GZIP)
        text = unzip.decompress(data, MAX_LINES_BYTES)
    except zlib.error as error:
        raise NoEvidence(str(error)) from error
    if not unzip.eof:
        raise NoEvidence("the end of the evidence is missing, or the evidence is larger than allowed")
    return text


def parse(lines: bytes) -> Kept:
    """Return the evidence that :func:`lines_of` has returned as lines.

    Raises:
        NoEvidence: The lines are not evidence, or are damaged.
    """
    try:
        first, *rows, last = [json.loads(line, object_hook=restored) for line in lines.splitlines()]
        looks = _looks(rows)
        expected = [part for look in looks if look.get("of") for part in look["parts"]]
        looks = [look for look in looks if not look.get("of")]
        return msgspec.convert({**first, **last, "looks": looks, "expected": expected}, type=Kept)
    except (ValueError, TypeError, LookupError, RecursionError) as error:
        raise NoEvidence(str(error)) from error


def _looks(rows: Sequence[Any]) -> list[dict[str, Any]]:
    looks: list[dict[str, Any]] = []
    for row in rows:
        if isinstance(row, list):
            looks[-1]["parts"][-1]["events"].append(
                dict(zip(("t", "kind", "name", "data", "sim"), row, strict=True))
            )
        elif "name" not in row:
            looks.append({**row, "parts": []})
        else:
            looks[-1]["parts"].append({**row, "events": []})
    return looks


def evidence_of(kept: Kept, expected: Reference) -> Evidence:
    """Return unpacked evidence in the form from which the judge derives verdicts.

    Args:
        kept: The unpacked verdict and evidence.
        expected: The reference output. A drawing of a class is not in it, so evidence has its own record of that.

    Raises:
        NoEvidence: The evidence contains no look.
    """
    evidence: Evidence | None = None
    reference = replace(expected, parts=kept.expected) if kept.expected else expected
    for look in kept.looks:
        evidence = Evidence(look.parts, reference, look.real_time, evidence)
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


def restored(value: dict[str, Any]) -> Any:
    """Undo :func:`plain` for numbers such as infinity, as the ``object_hook`` of ``json.loads``."""
    return float(value[_FLOAT]) if value.keys() == {_FLOAT} else value
