"""From a master in MyST Markdown to nbgrader's source notebook, and to the chapter notebook for students.

``docs/writing-a-master.md`` explains the format to authors.

This file imports nothing, so that importing one of the modules does not import all of them, and nbgrader.
"""
