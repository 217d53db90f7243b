"""The programs of students: JupyterLab, the course page, resetting a notebook, and the hand-out (the course's copy).

Promises: what a student typed is kept; a hand-out holds no solution and no grader.
Names: ``lab.open_lab``, ``handout.hand_out``, ``notebook_reset``, ``progress.standing``
Imports: ``cards``, ``check_journal``, ``course``, ``dds_discovery``, ``exercises``, ``masters``,
    ``packed_files``, ``process_trees``, ``safe_files``, ``standard_output``.
Takes: the student's folder, and the journal of checks beside the notebooks.
Gives: a running JupyterLab, a page of progress, a hand-out.
"""
