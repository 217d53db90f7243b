"""Appeals: saves the evidence of one check in a file, shows it, and judges it again.

The grader writes an appeal file from a class. Any person who has this file and the course can judge the check again,
without the class. That runs no student's code and starts no ROS node.
"""
