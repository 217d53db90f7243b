"""Commands for authors: make, try and record exercises, execute all notebooks, build the website.

Promises: nothing is written over that a person wrote; what an author is told about an exercise was seen on the wire or,
    for mutants of the solution, on paper.
Names: ``new_exercise``, ``exercise_trial``, ``reference_files``, ``notebook_execution.execute_command``,
    ``site_building.build_site``, ``answer_bank.answers``
Imports: ``boxes``, ``cards``, ``check_journal``, ``course``, ``dds_discovery``, ``execution``, ``exercises``,
    ``grading``, ``judge``, ``kit``, ``masters``, ``messages``, ``packed_files``, ``safe_files``,
    ``standard_output``, ``verdict``.
Takes: the folder of a lab: master, exercise, tables of answers.
Gives: reference outputs, the website, and what passes or fails, in words and as an exit code.
"""
