"""Makes `python -m course_runtime.ros2_command` run `ros2`."""

import sys

from course_runtime.ros2_command.main import main

if __name__ == "__main__":
    sys.exit(main())
