"""A fork server: it has imported what is slow to import, and forks a child for each connection it is asked on.

``python -P -m autograder.boxes.fork_server MODE MODULE DESCRIPTOR [WORD...]``, where ``MODULE`` offers ``prepare``,
called once with the words, and ``run``, called in each child. In the mode ``inside`` the child first enters the box
that is named (:mod:`autograder.boxes.entering`); in the mode ``beside`` ``run`` gets the connection itself.

This process starts with a clean environment, makes no thread and no ROS context, so that a fork is safe (LTTng, which
rclpy loads, has two threads of its own that sleep until there is a tracing daemon), and never reads what it is asked:
the child does. So nothing of one submission is ever in the memory that the next one's kernel begins with. It ends when
its standard input does, and its children with it.
"""

from __future__ import annotations

import contextlib
import gc
import importlib
import os
import select
import signal
import socket
import sys
import traceback
from pathlib import Path
from typing import Any

from autograder.boxes.channel import Channel
from autograder.boxes.limits import raise_own

BESIDE, INSIDE = "beside", "inside"
FOLDER_PREFIX = "autograder-held-"
"""The beginning of the names of fork servers' folders. Older versions used another word and no lock: theirs are left
alone."""
_LIBRARY_FOLDERS = 8
"""More packages with libraries than a workspace of the course has."""


def library_folders(address: str) -> list[Path]:
    """The folders in which the forks of a fork server look for libraries first: the loader reads their names but once.

    Where the fork server runs they are empty. In a box they are links to the folders of the box that hold libraries.

    Args:
        address: Where the fork server listens.
    """
    return [Path(f"{address}.libraries-{number}") for number in range(_LIBRARY_FOLDERS)]


def main(arguments: list[str]) -> None:
    """Serve until standard input ends.

    Args:
        arguments: The mode, the module, the descriptor of the listening socket, and what the module is told.
    """
    raise_own()
    mode, name, descriptor, *words = arguments
    listener = socket.socket(fileno=int(descriptor))
    module = importlib.import_module(name)
    module.prepare(*words)
    gc.collect()
    # What is here stays as it is in every child, so that their memory remains shared.
    gc.freeze()
    signal.signal(signal.SIGCHLD, signal.SIG_IGN)  # no zombie is left, and nobody asks how a child ended
    while True:
        watched: list[Any] = [listener, 0]
        ready, _, _ = select.select(watched, [], [])
        if 0 in ready and not os.read(0, 1):
            _tidy(listener.getsockname())
            return
        if listener in ready:
            connection, _ = listener.accept()
            if os.fork() == 0:
                _child(mode, module, listener, connection)
            connection.close()


def _tidy(address: str) -> None:
    """Take the socket away, and its folder where that was made for such sockets: its maker may have been killed."""
    socket_file = Path(address)
    with contextlib.suppress(OSError):
        socket_file.unlink(missing_ok=True)
        for folder in library_folders(address):
            if folder.is_dir():
                folder.rmdir()
        if socket_file.parent.name.startswith(FOLDER_PREFIX):
            socket_file.parent.rmdir()


def _child(mode: str, module: Any, listener: socket.socket, connection: socket.socket) -> None:
    """A child's whole life."""
    code = 1
    try:
        listener.close()
        null = os.open(os.devnull, os.O_RDWR)
        os.dup2(null, 0)
        os.dup2(null, 1)
        os.close(null)
        signal.signal(signal.SIGCHLD, signal.SIG_DFL)
        channel = Channel(connection)
        if mode == INSIDE:
            from autograder.boxes.entering import enter

            enter(channel, module.run)
        else:
            module.run(channel)
        code = 0
    except BaseException:
        traceback.print_exc()
    finally:
        sys.stderr.flush()
        os._exit(code)


if __name__ == "__main__":
    main(sys.argv[1:])
