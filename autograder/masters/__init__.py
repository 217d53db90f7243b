"""From a MyST Markdown master to the nbgrader source notebook and to the chapter notebook that students open.

``docs/writing-a-master.md`` is the author's guide to the format.
"""

from autograder.masters.chapters import BuildReport, build, build_command
from autograder.masters.errors import MasterError
from autograder.masters.layout import chapter_path, find_root, lab_name, masters
from autograder.masters.reference import Reference, reference_source
from autograder.masters.release import release_notebook, release_preprocessors, release_text
from autograder.masters.source import source_notebook

__all__ = [
    "BuildReport",
    "MasterError",
    "Reference",
    "build",
    "build_command",
    "chapter_path",
    "find_root",
    "lab_name",
    "masters",
    "reference_source",
    "release_notebook",
    "release_preprocessors",
    "release_text",
    "source_notebook",
]
