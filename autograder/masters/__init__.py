"""Turns a master (MyST Markdown) into nbgrader's source notebook, and that into the chapter notebook for students.

``docs/writing-a-master.md`` explains the format to authors.

This file imports nothing. Otherwise importing one module would import all the others, and nbgrader.
"""
