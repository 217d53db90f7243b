# family = "writing"
# tries = "Full marks are written into the gradebook, the table of grades and the journal, where they lie."
# could_earn = "All points, of anybody."
# undefended = "In stock nbgrader 0.9.5 and without a box, the gradebook could be written."

# %% extra
import os
import sys
from pathlib import Path

import sqlite3


def write(path, text):
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
        print("written", path)
    except OSError as error:
        print(type(error).__name__)


for path in Path('<<class>>/.autograder/journal').glob('*'):
    write(path, path.read_text().replace('"score":0.0', '"score":10.0'))
write(Path('<<class>>/submitted/<<mark>>_note'), 'I was here')
try:
    with sqlite3.connect('<<class>>/gradebook.db', timeout=1.0) as book:
        book.execute('update grade set auto_score = 10.0, manual_score = 10.0')
        print('written')
except sqlite3.Error as error:
    print(error)
