"""Students' colcon workspaces: built once for the same sources, and run without sourcing a setup script by hand.

The path of every workspace: its sources, their key, a build (here or in a box), its artefacts, the exercise's plan, a
program.
"""
