"""Appeals: what a judge saw in one check, kept in a file, shown to others and judged again.

An appeal file comes from the grader's side of a class. Whoever has it and the course can judge it again: no class is
needed, no student's code is run, and no ROS node is started.
"""
