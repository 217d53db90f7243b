"""Turns a master (MyST Markdown) into nbgrader's source notebook, and that into the chapter notebook for students.

Promises: the same master makes the same notebook, byte for byte; a fault of a master is named with its line.
    ``docs/writing-a-master.md`` explains the format. This file imports nothing: else importing one module would import
    nbgrader, too.
Names: ``master_files.masters``, ``master_cells.parse_master``, ``source_notebooks.source_notebook``,
    ``notebook_release.release_text``, ``reference_solutions.reference_source``, ``chapter_building``
Imports: ``course``, ``exercises``, ``safe_files``, ``standard_output``.
Takes: ``lab.md`` and the figures of a lab.
Gives: ``chapters/*.ipynb``, and the reference solutions as programs.
"""
