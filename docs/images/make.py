"""Take the pictures of the documentation: ``.venv/bin/python docs/images/make.py``.

They are what the browser tests see in a real JupyterLab, so a picture shows what the course does today.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
TESTS = ("tests/browser/test_lab_1_2.py", "tests/browser/test_course_page.py")
TAKEN = ("not-yet.png", "passed.png", "course-panel.png")
LARGEST = 300_000
"""Bytes: a clone should not grow with every new look of a card."""


def main() -> int:
    """Run the browser tests with a folder for its pictures, and keep those that the documentation shows."""
    with tempfile.TemporaryDirectory() as folder:
        test = [sys.executable, "-m", "pytest", "-q", *TESTS]
        ended = subprocess.run(
            test, cwd=HERE.parents[1], env=os.environ | {"SCREENSHOTS": folder}, check=False
        )
        missing = [name for name in TAKEN if not (Path(folder) / name).exists()]
        if ended.returncode or missing:
            print(f"no pictures: the browser tests must pass first {missing}", file=sys.stderr)
            return 1
        for name in TAKEN:
            picture = Path(folder) / name
            if picture.stat().st_size > LARGEST:
                print(f"{name} is larger than {LARGEST} bytes: make the window smaller", file=sys.stderr)
                return 1
            shutil.copy(picture, HERE / name)
    return 0


if __name__ == "__main__":
    sys.exit(main())
