"""The secret of a class, from which the seed of each student's random inputs is derived."""

from __future__ import annotations

import hashlib
import hmac
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


def seed_for(secret: bytes, student: str, assignment: str, notebook: str, work: str) -> str:
    """Return the seed of one student's notebook. The judge derives the seed of each exercise from it.

    Args:
        work: A hash of the submitted cells, so that a changed submission gets different inputs. Otherwise a student
            could copy inputs from the feedback into the next submission.
    """
    # The hashed message contains the lengths of the names, so that ("ab", "c") and ("a", "bc") give different seeds.
    message = "".join(f"{len(part)}:{part};" for part in (student, assignment, notebook, work))
    return hmac.new(secret, message.encode(), hashlib.sha256).hexdigest()[:32]
