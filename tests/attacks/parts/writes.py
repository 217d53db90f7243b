# Write a file if that is allowed, and say what came of it.
import os
from pathlib import Path


def write(path, text):
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
        print("written", path)
    except OSError as error:
        print(type(error).__name__)
