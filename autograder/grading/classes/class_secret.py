"""The secret of a class, from which :func:`autograder.grading.tasks.task_making.seed_for` derives students' seeds."""

from __future__ import annotations

import os
import secrets
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pathlib import Path

_SECRET_BYTES = 32


def create_secret(path: Path) -> None:
    """Write a new secret of a class into a file that only the owner can read.

    Raises:
        FileExistsError: The file exists. It is not replaced, because a new secret would change the inputs of every
            student.
    """
    descriptor = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600)
    with os.fdopen(descriptor, "w") as file:
        file.write(secrets.token_hex(_SECRET_BYTES))


def read_secret(path: Path) -> bytes:
    """Return the secret of a class.

    Raises:
        OSError: The file cannot be read.
        ValueError: The file is damaged.
    """
    secret = bytes.fromhex(path.read_text().strip())
    if len(secret) != _SECRET_BYTES:
        raise ValueError(f"{path} does not hold {_SECRET_BYTES} bytes")
    return secret
