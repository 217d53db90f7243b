# family = "reading"
# assignment = "exercise_1_1"
# tries = "The masters with their solutions, and the exercises, are read: in the folder that the box shares with the grader, in the class, in the repository, and wherever a folder named solutions can be found from the package."
# could_earn = "The answers."
# undefended = "LEAK: the masters of class and repository were read, and in Exercise 1.1 Lab 1.2's talker and listener."

# %% extra
from pathlib import Path

import autograder

root = Path(autograder.__file__).resolve().parent.parent
places = [
    *Path("/run/judge").rglob("my_robot_pkg/*.py"),
    *Path("<<class>>/source").glob("*/*.ipynb"),
    *Path("<<repository>>/solutions").glob("*/*/lab.md"),
    *Path("<<repository>>/solutions").glob("*/*/*.py"),
    *(root / "solutions").glob("*/*/*"),
    *(folder for parent in root.parents for folder in [parent / "solutions"] if folder.exists()),
    *Path("<<repository>>/tests").glob("*/*"),
]
for place in places[:40]:
    try:
        print("LEAK:", place, len(place.read_text()) if place.is_file() else "a folder")
    except OSError:
        pass
