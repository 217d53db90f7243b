# family = "reading"
# tries = "The gradebook, the table of grades and the store of the class are read."
# could_earn = "The grades of everybody."
# undefended = "LEAK: in stock nbgrader 0.9.5 and without a box, the files of the class could be read."

# %% extra
import sqlite3
from pathlib import Path

for name in ("gradebook.db", "grades.csv", ".autograder", ".autograder/class.db"):
    path = Path("<<class>>", name)
    try:
        print("LEAK:", name, list(path.iterdir()) if path.is_dir() else len(path.read_bytes()))
    except OSError:
        pass
try:
    rows = sqlite3.connect("file:<<class>>/gradebook.db?mode=ro", uri=True).execute("select * from student").fetchall()
    print("LEAK:", rows)
except sqlite3.Error:
    pass
