"""The name of the course's program in messages: ``./course`` in a clone or a hand-out, ``autograder`` for a wheel.

The other parts of the package take the name from here, so that only this part depends on how the course is installed.
"""

from __future__ import annotations

from course_runtime.installation import COMMAND

__all__ = ["COMMAND"]
