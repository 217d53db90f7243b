"""Builds students' colcon workspaces, and runs their programs.

The steps: read the sources, compute their key, build them (here or in a box), check the files that the build made, and
run the program that the exercise's plan names. The key is that of a cache, so the same sources are built only once. No
step needs a sourced setup script.
"""
