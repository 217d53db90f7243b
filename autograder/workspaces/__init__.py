"""Students' colcon workspaces: built once for the same sources, and run without sourcing a setup script by hand.

A workspace goes through these steps: its sources are read, a key is computed, it is built (here or in a box), the
artefacts are accepted, and by the exercise's plan a program is run.
"""
