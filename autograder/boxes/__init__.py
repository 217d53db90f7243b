"""Sandboxes (boxes) for submissions: separate namespaces, limits on every resource, no process left behind.

Promises: what a box sees, may call and may use is a list; everything in it ends with it; it knows nothing of what runs
    inside.
Names: ``sandbox.Enclosure``, ``sandbox.why_impossible``, ``run_limits.Limits``, ``run_limits.Ended``,
    ``visible_host.Bind``, ``visible_host.box_environment``, ``admission.admitted``
Imports: ``process_trees``, ``safe_files``, ``standard_output``.
Takes: limits, the files and variables to see, and the function or command to run.
Gives: sockets to the processes in the box, and how each of them ended.
"""
