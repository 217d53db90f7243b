"""The judge: a ROS node in its own process, which watches a subject on the wire and decides the verdict.

Promises: a verdict is a function of the evidence, so it can be judged again; nothing that a subject does ends the
    judge; what depends on a busy machine is “could not be checked”.
Names: ``one_check.check``, ``verdicts.deciding.judge``, ``check_server``, ``controlled_judge``, ``command_check``,
    ``reference_recording``, ``evidence_files``
Imports: ``course``, ``dds_discovery``, ``exercises``, ``kit``, ``messages``, ``packed_files``, ``process_trees``,
    ``safe_files``, ``standard_output``, ``verdict``, ``workspaces``.
Takes: an exercise of the kit, its reference output, a seed, and a subject on the ROS graph.
Gives: a verdict (``autograder.verdict``), and the evidence.
"""
