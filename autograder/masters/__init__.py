"""From a MyST Markdown master to the nbgrader source notebook and to the chapter notebook that students open.

``docs/writing-a-master.md`` is the author's guide to the format.

Nothing is imported here: who wants one of the modules would get all, and nbgrader with them.
"""
