"""Runs steps only once: each leaves a stamp of its inputs, and is skipped as long as the inputs are the same.

A step is also repeated if an earlier one was, unless that one stands alone. The stamp is removed before the step runs
and written after it has succeeded, so an interrupted set-up continues with the step that was interrupted.
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
"""Seconds after which the user is told that a step is still running; repeated after the same time."""


@dataclass(frozen=True)
class Step:
    """One step of the set-up.

    Attributes:
        name: The name of the step's stamp.
        doing: The text that the user sees while the step runs.
        inputs: The texts and files from which the result is made. If any of them changes, the step is repeated.
        run: Carries out the step. After an exception the step counts as not done.
        stands_alone: True if no later step builds on the result, so none is repeated because of this one.
    """

    name: str
    doing: str
    inputs: tuple[str | Path, ...]
    run: Callable[[], object]
    stands_alone: bool = False


def files_below(folder: Path) -> tuple[Path, ...]:
    """Return every file below a folder, in a fixed order."""
    return tuple(sorted(path for path in folder.rglob("*") if path.is_file()))


def digest(inputs: Iterable[str | Path], root: Path) -> str:
    """Return the SHA-256 (hexadecimal) of texts and files. A file counts with its path below `root` and its content."""
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
    """Run the steps that are not up to date, in order. Return their names.

    Args:
        steps: All steps, in order.
        stamps: The folder of the stamps, which is created if it does not exist.
        root: The folder to which the paths of the inputs are relative.
        say: Prints a line for the user.
    """
    done = []
    chain = ""
    for step in steps:
        made_from = digest([chain, step.name, *step.inputs], root)
        chain = chain if step.stands_alone else made_from
        stamp = stamps / step.name
        if _stamped(stamp) == made_from:
            continue
        stamp.unlink(missing_ok=True)
        started = time.monotonic()
        say(step.doing)
        with _signs_of_life(say):
            step.run()
        # This comes after the run, because the step that makes the environment empties the folder of the stamps.
        stamps.mkdir(parents=True, exist_ok=True)
        stamp.write_text(made_from, encoding="ascii")  # a stamp that is only partly written equals no digest
        say(f"  {time.monotonic() - started:.1f} s")
        done.append(step.name)
    return done


@contextlib.contextmanager
def _signs_of_life(say: Callable[[str], None]) -> Iterator[None]:
    """Tell the user from time to time that a step is still running; on a busy computer it may take many minutes."""
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
