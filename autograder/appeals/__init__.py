"""Appeals: saves the evidence of one check in a file, shows it, and judges it again.

Promises: a person with the file and the course gets the same verdict, or is told what differs; no student's code runs,
    and no ROS node starts.
Names: ``appeal_file.Appeal``, ``appeal_file.dump``, ``replaying.replay``, ``replaying.Replay``
Imports: ``exercises``, ``judge``, ``verdict``.
Takes: an appeal file: a zip with one check's evidence, the student's cells and page, and the verdict that was given.
Gives: the verdict now, and each difference from the one that was given.
"""
