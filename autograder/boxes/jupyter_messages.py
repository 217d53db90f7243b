"""Jupyter kernel messages as they are sent: four signed frames of JSON.

The format is that of the Jupyter messaging specification 5.4, "The Wire Protocol". ``jupyter_client.session`` does
the same, but importing it takes half the time in which a worker starts.
"""

from __future__ import annotations

import hmac
import json
import secrets
from datetime import UTC, datetime
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

_BEFORE = b"<IDS|MSG>"
"""The parts before this one hold routing data for ZeroMQ alone."""
_FRAMES = ("header", "parent_header", "metadata", "content")


class SignedMessages:
    """Writes and reads the messages between one kernel and its client.

    Args:
        key: The key that signs the messages.
    """

    def __init__(self, key: str) -> None:
        self._key = key.encode()
        self._session = secrets.token_hex(16)

    def written(self, message_type: str, content: Mapping[str, Any]) -> tuple[str, list[bytes]]:
        """Return a message's id and its parts."""
        header = {
            "msg_id": secrets.token_hex(16),
            "msg_type": message_type,
            "username": "",
            "session": self._session,
            "date": datetime.now(UTC).isoformat(),
            "version": "5.4",
        }
        frames = [json.dumps(part).encode() for part in (header, {}, {}, content)]
        return header["msg_id"], [_BEFORE, self._signature(frames), *frames]

    def read(self, parts: Sequence[bytes]) -> dict[str, Any]:
        """Return a message by the names of its frames, with its type as ``msg_type``.

        Raises:
            ValueError: The message does not have this format, or is not signed with the key.
            KeyError: Its header has no type.
            RecursionError: It is nested too deeply.
        """
        signature, *frames = parts[parts.index(_BEFORE) + 1 :][: 1 + len(_FRAMES)]
        if not hmac.compare_digest(signature, self._signature(frames)):
            raise ValueError("a message with a wrong signature")
        texts = (frame.decode("utf-8", "replace") for frame in frames)
        message: dict[str, Any] = dict(zip(_FRAMES, map(json.loads, texts), strict=True))
        return {**message, "msg_type": message["header"]["msg_type"]}

    def _signature(self, frames: Sequence[bytes]) -> bytes:
        return hmac.new(self._key, b"".join(frames), "sha256").hexdigest().encode()
