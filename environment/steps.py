"""Steps that are done once: each leaves a stamp of its inputs, and is skipped while they are the same.

A step is also done again when one before it was. The stamp is removed before the step runs and written when
it has succeeded, so an interrupted set-up goes on at the step it was in.
"""

from __future__ import annotations

import contextlib
import hashlib
import threading
import time
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Sequence

SIGN_OF_LIFE = 30.0
"""Seconds after which a step that still runs says so, again and again."""


@dataclass(frozen=True)
class Step:
    """One step of the set-up.

    Attributes:
        name: the name of its stamp.
        doing: what the user reads while it runs.
        inputs: texts and files that it is made from; any change of one has it done again.
        run: does it; an exception leaves it undone.
    """

    name: str
    doing: str
    inputs: tuple[str | Path, ...]
    run: Callable[[], object]


def files_below(folder: Path) -> tuple[Path, ...]:
    """Return every file below a folder, in a stable order."""
    return tuple(sorted(path for path in folder.rglob("*") if path.is_file()))


def digest(inputs: Iterable[str | Path], root: Path) -> str:
    """Return the SHA-256 (hexadecimal) of texts and files: of a file, its path below `root` and content."""
    total = hashlib.sha256()
    for item in inputs:
        if isinstance(item, Path):
            total.update(f"file {item.relative_to(root)}\n".encode())
            total.update(hashlib.sha256(item.read_bytes()).digest())
        else:
            total.update(f"text {item}\n".encode())
    return total.hexdigest()


def _stamped(stamp: Path) -> str:
    try:
        return stamp.read_text(encoding="ascii")
    except (OSError, UnicodeDecodeError):
        return ""


def run_steps(steps: Sequence[Step], stamps: Path, root: Path, say: Callable[[str], None]) -> list[str]:
    """Run the steps that are not up to date, in order, and return their names.

    Args:
        steps: all steps, first to last.
        stamps: the folder of the stamps; made when it is missing.
        root: the folder that the paths of the inputs are relative to.
        say: prints a line for the user.
    """
    done = []
    chain = ""
    for step in steps:
        chain = digest([chain, step.name, *step.inputs], root)
        stamp = stamps / step.name
        if _stamped(stamp) == chain:
            continue
        stamp.unlink(missing_ok=True)
        started = time.monotonic()
        say(step.doing)
        with _signs_of_life(say):
            step.run()
        # After the run: the step that makes the environment empties the folder of the stamps.
        stamps.mkdir(parents=True, exist_ok=True)
        stamp.write_text(chain, encoding="ascii")  # one that is written in part fits no digest
        say(f"  {time.monotonic() - started:.1f} s")
        done.append(step.name)
    return done


@contextlib.contextmanager
def _signs_of_life(say: Callable[[str], None]) -> Iterator[None]:
    """Say now and then that a step is still at work: on a busy computer one can take many minutes."""
    started = time.monotonic()
    ended = threading.Event()

    def tell() -> None:
        while not ended.wait(SIGN_OF_LIFE):
            say(f"  still at work, after {time.monotonic() - started:.0f} s")

    teller = threading.Thread(target=tell, daemon=True)
    teller.start()
    try:
        yield
    finally:
        ended.set()
        teller.join()
