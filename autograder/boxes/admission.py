"""Decides which answers of an untrusted process the grader uses.

Code of a student may have taken over the process, so its answer may be any bytes.
"""

from __future__ import annotations

from typing import Any

import msgspec


class NotAdmitted(ValueError):
    """An answer cannot be used: no process that follows its program would give it, or there is none.

    Attributes:
        code: The exit code of a process that failed and gave no answer (negative: the number of the signal that ended
            it); 0 if the answer itself was refused.
    """

    def __init__(self, reason: str, code: int = 0) -> None:
        super().__init__(reason)
        self.code = code


def admitted(data: bytes, kind: Any, most: int) -> Any:
    """Decode an answer, and return it.

    Args:
        data: The answer as JSON.
        kind: The only type that the answer may have. A condition that types cannot express belongs into the type's
            ``__post_init__``.
        most: The maximum size of the answer in bytes.

    Raises:
        NotAdmitted: The answer is too large, or does not have this type.
    """
    if len(data) > most:
        raise NotAdmitted(f"it has {len(data)} bytes; the limit is {most}")
    try:
        return msgspec.json.decode(data, type=kind)
    except (msgspec.MsgspecError, RecursionError, UnicodeError) as error:
        raise NotAdmitted(f"it has another form: {error}") from error
