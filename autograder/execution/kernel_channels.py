"""The channels between a Jupyter kernel, its desk and the grader, which opens them before the two start."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pathlib import Path

SHELL, IOPUB = 1, 2
"""The numbers of the used channels; the path of each channel's socket ends with its number."""


@dataclass(frozen=True)
class Channels:
    """The channels with which a kernel and its desk start.

    Attributes:
        folder: The folder of the kernel's sockets.
        key: The key that signs the messages.
        shell: The listening socket for requests.
        iopub: The listening socket for outputs.
        log: A pipe for what the kernel prints outside any cell; further text is dropped once the pipe is full.
        orders: The desk's end of the socket for its orders.
    """

    folder: Path
    key: str
    shell: int
    iopub: int
    log: int
    orders: int
