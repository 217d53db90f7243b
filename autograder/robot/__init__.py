"""The small robot of the course: how it moves, and what it senses, for the notebook and for the judge.

Promises: the same commands lead to the same places on every machine.
Names: ``motion.move``, ``motion.Pose``, ``sensors``, ``plan.Plan``
Imports: no other part.
Takes: a pose, a command and a world of walls.
Gives: the next pose, and the fields of ``/odom`` and ``/scan``.
"""
