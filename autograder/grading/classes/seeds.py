"""Seeds for random inputs that a student cannot guess, that differ between students, and that can be reproduced."""

from __future__ import annotations

import hashlib
import hmac
import os
import secrets
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pathlib import Path

_BYTES = 32


def create_secret(path: Path) -> None:
    """Write a new class secret, which only its owner can read.

    Raises:
        FileExistsError: A secret exists already. A new one would change every student's inputs.
    """
    descriptor = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600)
    with os.fdopen(descriptor, "w") as file:
        file.write(secrets.token_hex(_BYTES))


def read_secret(path: Path) -> bytes:
    """Return the class secret.

    Raises:
        OSError: The file cannot be read.
        ValueError: The file is damaged.
    """
    secret = bytes.fromhex(path.read_text().strip())
    if len(secret) != _BYTES:
        raise ValueError(f"{path} does not hold {_BYTES} bytes")
    return secret


def seed_for(secret: bytes, student: str, assignment: str, notebook: str, work: str) -> str:
    """Return the seed of one student's notebook. From this the judge derives a seed for each exercise.

    Args:
        secret: The class secret.
        student: The student's id.
        assignment: The assignment's name.
        notebook: The notebook's name.
        work: A hash of what was handed in. So a student who copies inputs from the feedback into the next submission
            gets different inputs there.
    """
    # The message contains the lengths, so that ("ab", "c") and ("a", "bc") never give the same seed.
    message = "".join(f"{len(part)}:{part};" for part in (student, assignment, notebook, work))
    return hmac.new(secret, message.encode(), hashlib.sha256).hexdigest()[:32]
