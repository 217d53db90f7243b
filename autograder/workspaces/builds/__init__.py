"""Builds of a workspace: colcon's command line, the cache of builds, and the install folder that colcon makes."""
