"""Appeals: saves the evidence of one check in a file, shows it, and judges it again.

The grader writes an appeal file from a class. Any person with this file and the course can judge the check again.
This needs no class, runs no student's code, and starts no ROS node.
"""
