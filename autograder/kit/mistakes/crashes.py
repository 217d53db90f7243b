"""Mistakes recognized from a traceback: which traceback counts, which mistake it shows, and the advice."""

from __future__ import annotations

import functools
from dataclasses import replace
from itertools import dropwhile
from typing import TYPE_CHECKING

import re2

from autograder import known_errors
from autograder.kit.evidence import is_cut_off
from autograder.kit.mistakes.traceback_lines import is_a_library, own_line, owner
from autograder.kit.model import Advice, Mistake, card_words, filled_in

if TYPE_CHECKING:
    from autograder.kit.evidence import Event, Evidence, Part
    from autograder.known_errors import KnownError

_WORDS = card_words(__file__)


_NO_CRASH = re2.compile(
    r"(?m)^(?:[\w.]+\.)?(?:TimeoutError|ExternalShutdownException|ROSInterruptException)\b"
)


def traceback_of(evidence: Evidence) -> str:
    """Return the traceback of the subject's last crash in any part; empty if there is none.

    Two kinds of traceback are not crashes: a TimeoutError, because a client is asked to raise it if there is no server;
    and an error in a thread that still uses ROS when the main program shuts ROS down. If there are several crashes, an
    accidental error is preferred to an exception that was raised on purpose, for example for a refused goal. A
    traceback that was cut off, because two threads printed at the same time, is returned only if there is no complete
    one.
    """
    last_first = [part.traceback for part in reversed(list(evidence)) if part.traceback]
    shown = sorted(last_first, key=lambda text: is_cut_off(text.split("\n")))
    crashes = [text for text in shown if not _NO_CRASH.search(text)]
    return next((text for text in crashes if not meant(text)), crashes[0] if crashes else "")


UNNAMED = "crashed"
"""The key of the rows of the table that have no diagnosis of their own."""


def _known(key: str, evidence: Evidence) -> Advice | None:
    """Return what the table of known errors says, if the row with this key is the first that matches.

    The traceback comes first. If no row names it, the subject's output is searched.
    """
    traceback = traceback_of(evidence)
    row = _row(traceback, evidence)
    if row is None or row.key == UNNAMED:
        said = [line for part in evidence for line in part.said() if "await_or_execute" not in line]
        traceback, row = "", known_errors.recognized("\n".join(said), "terminal")
    return Advice(row.means, row.do, traceback, uses=row.uses) if row is not None and row.key == key else None


def _row(traceback: str, evidence: Evidence) -> KnownError | None:
    types = [kind for ends in evidence.reference.interface.values() for kind in ends.values()]
    here = known_errors.packages(kind.partition("/")[0] for kind in types)
    return known_errors.recognized(traceback, "program", here, owner(traceback))


def _usual_step(traceback: str) -> str:
    """Return the next step after an exception that the table of known errors does not contain."""
    if _FRAME.search(traceback):
        return (
            "Read the traceback from the bottom. The last line says what went wrong; the lines above it say where. "
            "Correct the line that is in your code."
        )
    return (
        "This error was raised inside ROS. Look at what your code passes to ROS: at each create_... and each spin, "
        "compare the types, names and methods, and their order, with the lab's text."
    )


def what_and_where(traceback: str) -> str:
    """Return a text for a card: the exception that was raised, and the student's line that led to it."""
    line = _raised_line(traceback)
    frames = [found for found in _FRAME.finditer(traceback) if not is_a_library(found["file"])]
    where = f" (line {frames[-1]['line']}, in {frames[-1]['function']})" if frames else ""
    if not line or line.startswith("Traceback"):
        return f"its traceback is incomplete, because another thread ended the program{where}"
    return f"{_SUGGESTION.sub('', line.strip())}{where}"


def raised(how: str, traceback: str, next_step: str = "") -> Advice:
    """Return the advice on an exception that is not a known mistake.

    Args:
        how: The beginning of the sentence for the student: what the exception ended or prevented.
        next_step: What to do now; by default the advice that fits such an exception.
    """
    row = known_errors.recognized(traceback, "program", owner=owner(traceback))
    why, do, uses = (row.means, row.do, row.uses) if row else ("", _usual_step(traceback), ())
    text = f"{how}: {what_and_where(traceback)}{why and f'. {why}'}"
    return Advice(text, next_step or do, traceback, uses=uses)


_EXECUTOR = "rclpy/executors.py"
"""The file of rclpy that calls callbacks, so in a traceback, the code below a line of this file ran in a callback."""
_LOGGING = "/logging/__init__.py"
"""The file of Python's ``logging``. A traceback that begins in this file is not a crash: one log line could not be
written, and the program goes on.
"""
_SUGGESTION = re2.compile(r"\. Did you mean: .*")
"""Matches the name that Python proposes. A card leaves it out, because the next step names it if it is right."""
_FRAME = re2.compile(r'(?m)^ +File "(?P<file>[^"\n]*)", line (?P<line>\d+), in (?P<function>[^\n]*)$')


def _crashed(evidence: Evidence) -> Advice | None:
    traceback = traceback_of(evidence)
    if not traceback:
        return None
    outermost = _FRAME.search(traceback)
    if outermost and outermost["file"].endswith(_LOGGING):
        return raised(
            "A line could not be logged",
            traceback,
            "Find the line of your code below the words `Call stack`. Give logging one argument for each placeholder "
            "in its text, such as %s, or write an f-string.",
        )
    spun = _was_spun(evidence) or _EXECUTOR in traceback
    return raised(
        "Spinning the node ended with an exception" if spun else "The program stopped with an exception",
        traceback,
    )


def _exception_in_callback(evidence: Evidence) -> Advice | None:
    traceback = traceback_of(evidence)
    files = [frame["file"] for frame in _FRAME.finditer(traceback)]
    spins = next((place for place, file in enumerate(files) if file.endswith(_EXECUTOR)), len(files))
    called = files if _was_spun(evidence) else files[spins:]
    if all(map(is_a_library, called)) and ", in await_or_execute\n" not in traceback:
        # ROS itself raised the exception, not a callback: for example, an object that is not a node was spun.
        return None
    return raised("A callback raised an exception, and that ended the spinning of the node", traceback)


def _was_spun(evidence: Evidence) -> bool:
    """Return True if a notebook's node existed when the exception was raised. Then it counts as spun."""
    return any(p.first("subject", "constructed") for p in evidence if p.ending and p.ending.name == "raised")


def _is_mute(part: Part) -> bool:
    """Return True if a notebook did not even begin to make the node: it no longer answers the judge."""
    return bool(part.first("subject", "never_constructed") and not part.first("subject", "started"))


def _cut_off(evidence: Evidence) -> Advice | None:
    if any(map(_is_mute, evidence)):
        return filled_in(_WORDS["no_longer_answers"])
    gone = next((event for part in evidence for event in part.of("subject", "gone")), None)
    if gone is None:
        return None
    return filled_in(_WORDS["cut_off"], why=gone.data.get("why") or "nothing more came")


_NONE_FOR_AN_ANSWER = re2.compile(
    r"\.sum\b.*\n(?:[ ~^]*\n)?AttributeError: 'NoneType' object has no attribute 'sum'"
)
LEFT_LYING = 0.3
"""The seconds for which an answer must have been available before the advice says that the client did not read it."""


def _answer_not_taken(evidence: Evidence) -> Advice | None:
    """Return advice if the client read ``sum`` of None although the service had answered: a call has timed out.

    Two runs have to show this, because in a single run a busy machine may have delayed the answer. A run in which the
    answer came just before the exception, or after it, shows nothing. If the failing line contains ``result()``, the
    result is None, because the client may never have waited for its future.
    """
    answered = [part for part in evidence if _got_an_answer(part)]
    unread = [part for part in answered if _left_its_answer_unread(part)]
    if len(unread) < max(1, min(2, len(answered))) or not all(map(_had_none_instead, answered)):
        return None
    return filled_in(_WORDS["answer_not_taken"], traceback=unread[0].traceback)


def _got_an_answer(part: Part) -> bool:
    given = part.first("response")
    return given is not None and (part.ending is None or given.t <= _stopped_at(part, part.ending))


def _stopped_at(part: Part, ending: Event) -> float:
    """Return when the client's traceback ended; if it has none, when the client ended."""
    outputs = (event for event in part.of("output") if _raised_line(part.traceback) in event.data["text"])
    return (next(outputs, ending) if part.traceback else ending).t


def _left_its_answer_unread(part: Part) -> bool:
    given = part.first("response")
    return bool(given and part.ending and _stopped_at(part, part.ending) > given.t + LEFT_LYING)


def _had_none_instead(part: Part) -> bool:
    found = _NONE_FOR_AN_ANSWER.search(part.traceback)
    if found is None or "result()" in found[0] or part.ending is None:
        return False
    # If the client waited in a callback, the node was spun.
    return "rclpy/executors.py" not in part.traceback


def _only_slips(mistake: Mistake) -> Mistake:
    def recognize(evidence: Evidence) -> Advice | None:
        return None if meant(traceback_of(evidence)) else mistake.recognize(evidence)

    return replace(mistake, recognize=recognize)


CRASHES: tuple[Mistake, ...] = (
    Mistake("call_never_spun", _answer_not_taken),
    *(
        Mistake(key, functools.partial(_known, key), certain=True)
        for key in dict.fromkeys(
            row.key for row in known_errors.rows() if {"program", "terminal"} & {*row.heard}
        )
        if key != UNNAMED
    ),
    Mistake("cut_off", _cut_off, certain=True),
)
"""The mistakes that the table of known errors names, and a kernel that ended."""
OTHER_CRASHES = (
    Mistake("exception_in_callback", _exception_in_callback, certain=True),
    Mistake("crashed", _crashed, certain=True),
)
"""The mistakes for any other traceback. They are checked after the mistakes that the ROS graph shows."""
OTHER_SLIPS = tuple(map(_only_slips, OTHER_CRASHES))
"""Like :data:`OTHER_CRASHES`, but only for accidental errors. Exceptions raised on purpose are checked after all other
mistakes.
"""


SLIPS = ("AttributeError", "TypeError", "NameError", "UnboundLocalError", "KeyError", "IndexError")
"""The types of exceptions that programs do not raise on purpose, so they count as accidental errors."""


def raised_lines(traceback: str) -> list[str]:
    """Return the lines of a traceback's last exception: its type, its message (one or more lines) and its notes."""
    lines = traceback.rstrip().splitlines()
    frames = [place for place, line in enumerate(lines) if _FRAME.match(line)]
    behind = lines[frames[-1] + 1 :] if frames else lines[-1:]
    return [line for line in dropwhile(lambda line: not line[:1].strip(), behind) if line.strip()]


def _raised_line(traceback: str) -> str:
    """Return the last exception's type and the first line of its message, as one line; empty if there is none."""
    return next(iter(raised_lines(traceback)), "")


def on_purpose(traceback: str) -> bool:
    """Return True if the student's code raised the exception itself, or if its type is not in :data:`SLIPS`."""
    line = _raised_line(traceback)
    return bool(line) and (meant(traceback) or not line.startswith(SLIPS))


def meant(traceback: str) -> bool:
    """Return True if the innermost line of a traceback is a ``raise`` or ``assert`` of the student."""
    return re2.search(r"(?:^|[:;] *)(?:raise|assert)\b", own_line(traceback)) is not None
