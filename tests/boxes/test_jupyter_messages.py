"""Our messages of a kernel beside those of jupyter_client, which kernels speak."""

from __future__ import annotations

import pytest
from jupyter_client.session import Session

from autograder.boxes.jupyter_messages import SignedMessages

KEY = "0123456789abcdef"


def theirs() -> Session:
    return Session(key=KEY.encode(), check_pid=False)


def test_jupyter_reads_what_we_write() -> None:
    asked, parts = SignedMessages(KEY).written("execute_request", {"code": "ř\ud800 = 1"})
    read = theirs().deserialize(theirs().feed_identities(parts)[1])
    assert read["header"]["msg_id"] == asked
    assert read["msg_type"] == "execute_request"
    assert read["content"] == {"code": "ř\ud800 = 1"}


def test_we_read_what_jupyter_writes() -> None:
    session = theirs()
    asked = session.msg("execute_request", {"code": "1"})
    answer = session.msg("stream", {"name": "stdout", "text": "ř"}, parent=asked)
    read = SignedMessages(KEY).read([b"kernel.1.stream", *session.serialize(answer)])
    assert read["msg_type"] == "stream"
    assert read["parent_header"]["msg_id"] == asked["header"]["msg_id"]
    assert read["content"] == {"name": "stdout", "text": "ř"}


@pytest.mark.parametrize("place", range(2, 6))
def test_a_changed_part_is_no_message(place: int) -> None:
    _, parts = SignedMessages(KEY).written("kernel_info_request", {})
    parts[place] = b'{"msg_type": "status"}'
    with pytest.raises(ValueError, match="signature"):
        SignedMessages(KEY).read(parts)


def test_what_has_not_the_form_of_a_message_is_none() -> None:
    _, parts = SignedMessages(KEY).written("kernel_info_request", {})
    for wrong in ([], parts[1:], parts[:2], parts[:5], [parts[0]]):
        with pytest.raises(ValueError, match=r"."):
            SignedMessages(KEY).read(wrong)
