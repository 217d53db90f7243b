"""The modules with which exercises are written: the model, the evidence, recipes, and common rules and mistakes.

Promises: an exercise reads like its specification; neither ROS nor the judge is imported, so that evidence is judged
    without them.
Names: ``model.Exercise``, ``bench.Bench``, ``evidence.Evidence``, ``draft.Draft``,
    ``oracle.same_as_solution.SameAsSolution``, ``mission.mission.Mission``, ``quests.quest.Quest``,
    ``hunts.ticket.repair``
Imports: ``known_errors``, ``packed_files``, ``robot``, ``verdict``.
Takes: what an author declares: inputs, outputs, worlds, mistakes.
Gives: an ``Exercise``: a scenario for the bench, and criteria and mistakes, which are functions of evidence.
"""
