"""Builds of a workspace: colcon, the cache of builds, and what colcon leaves in the install folder."""
