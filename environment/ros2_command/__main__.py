"""Makes `python -m environment.ros2_command` run `ros2`."""

import sys

from environment.ros2_command.main import main

if __name__ == "__main__":
    sys.exit(main())
