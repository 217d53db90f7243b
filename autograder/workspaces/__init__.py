"""Builds students' colcon workspaces, and runs their programs.

Each workspace is built only once for the same sources. The steps: read the sources, compute their key, build them (here
or in a box), check the files that the build made, and run the program that the exercise's plan names. No step needs a
sourced setup script.
"""
