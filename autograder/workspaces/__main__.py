"""``python -m autograder.workspaces``: what a check runs in place of a path."""

from __future__ import annotations

import sys

from autograder.workspaces.running.running import main

if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
