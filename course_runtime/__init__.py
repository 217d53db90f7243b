"""The machine that the package runs on: its Python processes, its ROS, ``doctor``, and ``ros2`` without a sourced ROS.

The set-up of a clone (``environment/``) imports this before anything is installed, so only the modules that talk to
ROS import more than the standard library.
"""
