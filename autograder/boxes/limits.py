"""The limits that hold while a notebook runs."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Limits:
    """Every limit has its own clear word in the feedback.

    Attributes:
        cell_seconds: Wall time of one cell. A check cell gets its exercise's limit and ``check_margin``
            instead.
        check_margin: Seconds beyond the judge's own limit, so that its verdict arrives before the cell is
            stopped.
        notebook_seconds: Wall time of all cells together, checks included.
        interrupt_grace: Seconds that an interrupted cell has to end before its kernel is killed.
        start_seconds: Wall time until a kernel must have answered.
        cell_output_bytes: Output kept of one cell; the rest is dropped and a line says so.
        notebook_output_bytes: Output kept of all cells together.
        message_bytes: Largest single message that is read from a kernel.
        flood_bytes: Output that a cell may send, kept or not, before it is stopped.
        cpu_seconds: Processor time of a box's processes together.
        memory_bytes: Memory of a box's processes together, files in its scratch included.
        processes: Processes and threads of a box together.
        open_files: Files, sockets and pipes that one process may have open.
        scratch_bytes: What a box's files may have together.
        scratch_files: How many files, folders and links a box may have.
    """

    # A first colcon build of interfaces takes 10 s on an idle machine and most of a minute on a busy one.
    cell_seconds: float = 120.0
    check_margin: float = 10.0
    notebook_seconds: float = 900.0
    interrupt_grace: float = 3.0
    start_seconds: float = 60.0
    cell_output_bytes: int = 200_000
    notebook_output_bytes: int = 2_000_000
    message_bytes: int = 8_000_000
    flood_bytes: int = 50_000_000
    cpu_seconds: float = 600.0
    memory_bytes: int = 2_000_000_000
    processes: int = 500
    open_files: int = 1024
    scratch_bytes: int = 1_000_000_000
    scratch_files: int = 100_000
