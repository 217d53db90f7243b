"""Builds students' colcon workspaces, and runs their programs.

Promises: the same sources are built once, and a grade depends on a build that was made in a box, from the sources
    alone. No step needs a sourced setup script.
Names: ``program_preparation``, ``program_plans``, ``graded_builds.build_ahead``, ``grading_service.WorkspaceService``,
    ``jobs.PlainJobs``, ``boxed_jobs.BoxedJobs``, ``sources``
Imports: ``boxes``, ``course``, ``exercises``, ``kit``, ``messages``, ``process_trees``, ``safe_files``,
    ``standard_output``.
Takes: the sources of a workspace, and an exercise's plan.
Gives: an install folder, a running program, and a report of what failed.
"""
