# Wrong: the robot of the course, each time.
print({'node': 'robot', 'type': 'small_robot_interfaces/action/WalkTo'})
