# Wrong: the robot of the course, each time.
print({'robot': 'robot', 'topic': '/cmd_vel'})
