"""Students' colcon workspaces: built once for the same sources, and run without sourcing anything by hand.

The one path: sources, their key, a build (here or in a box), its artefacts, the exercise's plan, a program.
"""
