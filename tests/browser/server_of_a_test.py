"""A Jupyter server of a test's own, which knows nothing of the user's settings."""

from __future__ import annotations

import contextlib
import json
import re
import socket
import subprocess
import sys
import threading
import time
from typing import TYPE_CHECKING, Any
from urllib.request import Request, urlopen

import pytest

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence
    from pathlib import Path

_PLACES = ("HOME", "IPYTHONDIR", "JUPYTER_CONFIG_DIR", "JUPYTER_DATA_DIR", "JUPYTER_RUNTIME_DIR")


@contextlib.contextmanager
def jupyter_server(
    arguments: Sequence[str], token: str, home: Path, environ: Mapping[str, str], cwd: Path | None = None
) -> Iterator[str]:
    """Start a server; its address, which ends with a slash.

    Args:
        arguments: What follows ``python -m``.
        token: Lets a browser in.
        home: Where its settings are.
        environ: The rest of its environment.
        cwd: Its folder.
    """
    command = [sys.executable, "-m", *arguments, "--no-browser", "--allow-root"]
    options = ["--ServerApp.port=0", f"--IdentityProvider.token={token}"]
    places = {name: str(home / name) for name in _PLACES}
    with subprocess.Popen(
        [*command, *options], env={**environ, **places}, cwd=cwd, stderr=subprocess.PIPE, text=True
    ) as server:
        assert server.stderr is not None
        said: list[str] = []
        try:
            for line in server.stderr:
                said.append(line)
                if found := re.search(r"http://127\.0\.0\.1:(\d+)/", line):
                    break
            else:
                pytest.fail("the server did not start:\n" + "".join(said))
            # A full pipe would stop it.
            threading.Thread(target=server.stderr.read, daemon=True).start()
            _await_open(server, int(found[1]))
            yield found.group()
        finally:
            server.terminate()


def _await_open(server: subprocess.Popen[str], port: int) -> None:
    """Wait until the server listens: it names its port before that (``jupyter_server/serverapp.py``)."""
    while server.poll() is None:
        with contextlib.suppress(ConnectionRefusedError):
            socket.create_connection(("127.0.0.1", port)).close()
            return
        time.sleep(0.05)
    pytest.fail("the server ended before it listened")


def forget_what_was_open(server: str) -> None:
    """End the kernels of a JupyterLab, and have it open no notebook again that was open when its page was closed.

    Args:
        server: The address of each of its pages, token included.
    """

    def ask(path: str, method: str = "GET") -> Any:
        with urlopen(Request(server.format(path), method=method), timeout=60) as answer:
            return json.loads(answer.read() or b"null")

    for session in ask("api/sessions"):
        ask(f"api/sessions/{session['id']}", "DELETE")
    for workspace in ask("lab/api/workspaces")["workspaces"]["ids"]:
        ask(f"lab/api/workspaces/{workspace}", "DELETE")
