"""XML launch files. The reader itself is in `launch.frontend`."""
