"""Whether this machine delivers is told from what this process sends to itself."""

from __future__ import annotations

import errno
import os
import select
import socket
from typing import TYPE_CHECKING

from autograder.judge import machine_fitness

if TYPE_CHECKING:
    import pytest


def test_a_machine_delivers() -> None:
    assert machine_fitness.delivers()


def test_not_where_nothing_more_may_be_watched(monkeypatch: pytest.MonkeyPatch) -> None:
    class Full:
        def __enter__(self) -> Full:
            return self

        def __exit__(self, *_: object) -> None:
            pass

        def register(self, *_: object) -> None:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(select, "epoll", Full)
    assert not machine_fitness.delivers()


def test_not_where_a_socket_has_room_for_a_few_datagrams_only(monkeypatch: pytest.MonkeyPatch) -> None:
    class Small(socket.socket):
        def bind(self, address: object) -> None:
            self.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
            super().bind(address)  # type: ignore[arg-type]

    monkeypatch.setattr(socket, "socket", Small)
    monkeypatch.setattr(machine_fitness, "_ARRIVES_WITHIN", 0.2)
    assert not machine_fitness.delivers()
