"""Runs a notebook cell by cell: its kernel, the desk that reads the kernel's messages, and the result of each cell.

Promises: a kernel that crashes, hangs or floods costs its own cells only; what the kernel says is read in a box.
Names: ``notebook_runner``, ``notebook_processes.BoxedProcesses``, ``notebook_processes.UnboxedProcesses``,
    ``executed_cells.Cell``, ``executed_cells.Execution``, ``verdicts_without_judge.zero_points``
Imports: ``boxes``, ``messages``, ``safe_files``, ``verdict``.
Takes: the cells of a rebuilt notebook, and limits.
Gives: an ``Execution``: outputs and verdict of each cell, as plain data.
"""
