"""Mistakes recognized from a traceback: which traceback counts, which mistake it shows, and the advice."""

from __future__ import annotations

from dataclasses import replace
from itertools import dropwhile
from typing import TYPE_CHECKING, Any

import re2

from autograder import code_of_elsewhere
from autograder.kit.evidence import is_cut_off
from autograder.kit.known_crashes import KNOWN, NOT_SPUN_WHILE_CALLING
from autograder.kit.model import Advice, Mistake
from autograder.kit.python_errors import meaning
from autograder.kit.quoted_names import MARKS, Name, is_a_library, names, own_line

if TYPE_CHECKING:
    from autograder.code_of_elsewhere import Elsewhere
    from autograder.kit.evidence import Evidence, Part
    from autograder.kit.known_crashes import Crash


_NO_CRASH = re2.compile(
    r"(?m)^(?:[\w.]+\.)?(?:TimeoutError|ExternalShutdownException|ROSInterruptException)\b"
)


def traceback_of(evidence: Evidence) -> str:
    """Return the last traceback of any part that shows a crash.

    A TimeoutError does not count, because a client is asked to raise it if there is no server. Neither does an error
    in a thread when the main program shuts ROS down under it. An exception raised on purpose in one part, such as for
    a refused goal, does not hide a slip in another part. A traceback that was cut off, because two threads printed at
    once, counts only if there is no other.
    """
    last_first = [part.traceback for part in reversed(list(evidence)) if part.traceback]
    shown = sorted(last_first, key=lambda text: is_cut_off(text.split("\n")))
    crashes = [text for text in shown if not _NO_CRASH.search(text)]
    return next((text for text in crashes if not meant(text)), crashes[0] if crashes else "")


def _recogniser(crash: Crash | Elsewhere) -> Mistake:
    compiled = re2.compile(f"(?m){crash.pattern}")

    def recognise(evidence: Evidence) -> Advice | None:
        traceback = traceback_of(evidence)
        found = compiled.search(traceback)
        if found is None:
            return None
        said = {name: Name(text or "") for name, text in found.groupdict().items()}
        types = [kind for ends in evidence.reference.interface.values() for kind in ends.values()]
        here = code_of_elsewhere.packages(kind.partition("/")[0] for kind in types)
        words = meaning(traceback)._asdict() | names(traceback) | {"here": Name(here)} | said
        return Advice(crash.text.format(**words).rstrip(), crash.next_step.format(**words), traceback)

    return Mistake(crash.key, recognise, certain=True)


def what_and_where(traceback: str) -> str:
    """The exception that was raised, and the line of the student's that led to it."""
    line = raised_line(traceback)
    frames = [found for found in _FRAME.finditer(traceback) if not is_a_library(found["file"])]
    where = f" (line {frames[-1]['line']}, in {frames[-1]['function']})" if frames else ""
    if not line or line.startswith("Traceback"):
        return f"another of its threads ended it before it had said which{where}"
    return f"{line.strip()}{where}"


def raised(how: str, traceback: str) -> Advice:
    """Return the advice for an exception that is not a known mistake.

    Args:
        how: The consequence, for the beginning of the sentence.
        traceback: Its traceback.
    """
    why, next_step = meaning(traceback)
    return Advice(f"{how}: {what_and_where(traceback)}{why and f'. {why}'}", next_step, traceback)


_EXECUTOR = "rclpy/executors.py"
"""The file that calls callbacks: the student's code below it in a traceback is a callback."""
_FRAME = re2.compile(r'(?m)^ +File "(?P<file>[^"\n]*)", line (?P<line>\d+), in (?P<function>[^\n]*)$')


def _crashed(evidence: Evidence) -> Advice | None:
    traceback = traceback_of(evidence)
    if not traceback:
        return None
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
        return (
            None  # not in a callback: ROS itself raised it, such as for spinning an object that is not a node
        )
    return raised("A callback raised an exception, and that ended the spinning of the node", traceback)


def _was_spun(evidence: Evidence) -> bool:
    """True if a notebook's node raised its exception after it was made; the traceback alone does not show that."""
    return any(p.first("subject", "constructed") for p in evidence if p.ending and p.ending.name == "raised")


def _cut_off(evidence: Evidence) -> Advice | None:
    gone = next((event for part in evidence for event in part.of("subject", "gone")), None)
    if gone is None:
        return None
    return Advice(
        "The check was cut off: your notebook's kernel ended, or said what the judge cannot take "
        f"({gone.data.get('why') or 'nothing more came'}).",
        "Leave out what ends the kernel, such as os._exit or exit(), and what prints without an end.",
    )


_NONE_FOR_AN_ANSWER = re2.compile(
    rf"\.sum\b.*{MARKS}AttributeError: 'NoneType' object has no attribute 'sum'"
)
LEFT_LYING = 0.3
"""Seconds that an answer must have been available before the client is said not to have taken it."""


def _answer_not_taken(evidence: Evidence) -> Advice | None:
    """In each run the client goes on without an answer that was available for a while, as after a call with a limit.

    In a single run, a busy machine may have delayed it. A value read from a future may never have been waited for.
    """
    answered = [part for part in evidence if part.first("response") is not None]
    if not answered or not all(map(_went_on_without_it, answered)):
        return None
    return Advice(
        "The service answered, and your client went on without the answer: it had None in its place. A "
        "call(..., timeout_sec=...) gives None when its time is over and nothing has spun the node.",
        NOT_SPUN_WHILE_CALLING,
        answered[0].traceback,
    )


def _went_on_without_it(part: Part) -> bool:
    given, found = part.first("response"), _NONE_FOR_AN_ANSWER.search(part.traceback)
    if given is None or found is None or "result()" in found[0] or part.ending is None:
        return False
    if "rclpy/executors.py" in part.traceback:
        return False  # it waited in a callback: the spinning was not what was missing
    outputs = (e for e in part.of("output") if raised_line(part.traceback) in e.data["text"])
    return next(outputs, part.ending).t > given.t + LEFT_LYING


_COROUTINE = re2.compile(
    # A method, or a function of rclpy, may be a callback that did not run before the program ended.
    r"^<coroutine object (?P<returned>\S+) at |RuntimeWarning: coroutine '(?P<warned>[a-z]\w*)' was never awaited"
)


def _never_awaited(evidence: Evidence) -> Advice | None:
    """Return advice if a coroutine of the student was never awaited: its value or Python's warning shows that."""
    said = [line for part in evidence for line in part.said()]
    found = next(filter(None, map(_COROUTINE.search, said)), None)
    name = (found["returned"] or found["warned"]).rpartition(".")[2] if found else ""
    if name in ("", "await_or_execute"):
        return None
    return Advice(
        f"{name} is an `async def`: calling it only makes a coroutine, and nothing inside it runs before something "
        "awaits that.",
        "Write def in place of async def. In place of an await, wait for the future: "
        "rclpy.spin_until_future_complete(your_node, your_future, timeout_sec=5.0).",
    )


_GENERATOR = re2.compile(r"^<generator object (?P<name>\S+) at ")


def _never_iterated(evidence: Evidence) -> Advice | None:
    """The advice for a notebook's function that has a ``yield``, so that its call runs nothing of it."""
    found = next(filter(None, (_GENERATOR.match(part.returned or "") for part in evidence)), None)
    if found is None:
        return None
    name = found["name"].rpartition(".")[2]
    return Advice(
        f"{name} has a `yield`: calling it only makes a generator, and nothing inside it runs before something asks "
        "that for a value.",
        "Write return instead of yield.",
    )


_NO_FILE = re2.compile(r"^\S*python[\d.]*: can't (?:open file|find '__main__' module in) '(?P<file>[^'\n]*)'")


def _file_not_found(evidence: Evidence) -> Advice | None:
    """Python says that it cannot open the file of the command, so nothing of the student's has run."""
    found = _said_without_a_node(evidence, _NO_FILE)
    if found is None:
        return None
    return Advice(
        f"Python does not find the program {found['file']}, so nothing of yours has run.",
        "Write the path of your program behind python3. `ls` lists the files of the folder that the terminal is in, "
        "and `cd FOLDER` goes to another folder.",
    )


_NO_PACKAGE = re2.compile(r"^Package (?:'(?P<name>[^']*)' )?not found")


def _package_not_found(evidence: Evidence) -> Advice | None:
    """`ros2` says that it knows no such package, and ends: nothing of the student's has run."""
    found = _said_without_a_node(evidence, _NO_PACKAGE)
    if found is None:
        return None
    return Advice(
        f"ROS does not know the package{' ' + found['name'] if found['name'] else ''} in this terminal, so nothing of "
        "yours has run.",
        "In the folder of your workspace type `colcon build`, then `source install/setup.bash`, and check again in the "
        "same terminal. Each new terminal needs the second line again.",
    )


def _said_without_a_node(evidence: Evidence, pattern: Any) -> Any:
    """Return the first match in what a program said that ended and had no node; None if there is none."""
    said = [line for part in evidence if part.ending and not part.had_node for line in part.said()]
    return next(filter(None, map(pattern.search, said)), None)


def _only_slips(mistake: Mistake) -> Mistake:
    def recognise(evidence: Evidence) -> Advice | None:
        return None if meant(traceback_of(evidence)) else mistake.recognise(evidence)

    return replace(mistake, recognise=recognise)


CRASHES: tuple[Mistake, ...] = (
    Mistake("call_never_spun", _answer_not_taken),
    *map(_recogniser, code_of_elsewhere.ROWS),
    *map(_recogniser, KNOWN),
    Mistake(code_of_elsewhere.KEY, _never_awaited, certain=True),
    Mistake("not_returned", _never_iterated, certain=True),
    Mistake("cut_off", _cut_off, certain=True),
    Mistake("module_not_found", _file_not_found, certain=True),
    Mistake("module_not_found", _package_not_found, certain=True),
)
"""The known tracebacks, most telling first, a kernel that went away, and a package that ROS does not find."""
OTHER_CRASHES = (
    Mistake("exception_in_callback", _exception_in_callback, certain=True),
    Mistake("crashed", _crashed, certain=True),
)
"""Any other traceback; checked after the mistakes that the graph shows."""
OTHER_SLIPS = tuple(map(_only_slips, OTHER_CRASHES))
"""Tracebacks of accidental errors; exceptions raised on purpose are checked after all other mistakes."""


SLIPS = ("AttributeError", "TypeError", "NameError", "UnboundLocalError", "KeyError", "IndexError")
"""Exceptions that programs do not raise on purpose."""


def raised_lines(traceback: str) -> list[str]:
    """Return the lines of the exception at the end of a traceback: type, message (of one line or more), notes."""
    lines = traceback.rstrip().splitlines()
    frames = [place for place, line in enumerate(lines) if _FRAME.match(line)]
    behind = lines[frames[-1] + 1 :] if frames else lines[-1:]
    return [line for line in dropwhile(lambda line: not line[:1].strip(), behind) if line.strip()]


def raised_line(traceback: str) -> str:
    """Return the type of the exception in a traceback with the first line of its message, or an empty string."""
    return next(iter(raised_lines(traceback)), "")


def on_purpose(traceback: str) -> bool:
    """True if a program ended with an exception that it raised itself, or with one that is not in :data:`SLIPS`."""
    line = raised_line(traceback)
    return bool(line) and (meant(traceback) or not line.startswith(SLIPS))


def meant(traceback: str) -> bool:
    """True if the innermost line of a traceback is the program's own ``raise`` or ``assert``."""
    return re2.search(r"(?:^|[:;] *)(?:raise|assert)\b", own_line(traceback)) is not None
