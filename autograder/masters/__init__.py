"""Turn a MyST Markdown master into nbgrader's source notebook and into the chapter notebook for students.

``docs/writing-a-master.md`` is the author's guide to the format.

This file imports nothing, so that importing one module does not import all of them, and nbgrader.
"""
