"""Grading a class, that is, an nbgrader course directory whose notebooks are judged on the wire.

Promises: a grade follows from what was handed in, the class and the course alone; a run that is killed goes on where it
    was; nothing that a person typed is lost.
Names: ``batch``, ``collecting.collect``, ``new_classes.new_class``, ``reporting``, ``running.execution_backends``,
    ``class_store``, ``grading_task.Task``
Imports: ``appeals``, ``boxes``, ``cards``, ``course``, ``execution``, ``exercises``, ``judge``, ``kit``, ``masters``,
    ``messages``, ``process_trees``, ``safe_files``, ``standard_output``, ``student``, ``verdict``, ``workspaces``.
Takes: downloads of an LMS, and the folder of a class.
Gives: grades in nbgrader's gradebook, the class's store (``class.db``), pages, tables and exports.
"""
