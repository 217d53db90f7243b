# family = "reading"
# tries = "The masters with their solutions, and the exercises, are read: in the class, in the repository, and wherever a folder named solutions can be found from the package."
# could_earn = "The answers."
# undefended = "LEAK: the masters of class and repository were read."

# %% extra
from pathlib import Path

import autograder

root = Path(autograder.__file__).resolve().parent.parent
places = [
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
