"""Appeals: save the evidence of one check in a file, show it, and judge it again.

The grader writes an appeal file from a class. Anyone with the file and the course can judge it again: no class is
needed, no student's code is run, and no ROS node is started.
"""
