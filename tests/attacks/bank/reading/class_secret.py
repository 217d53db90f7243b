# family = "reading"
# tries = "The class secret is read, from which every student's hidden inputs are drawn, and the words between grader and worker are looked for."
# could_earn = "The hidden inputs of every check, of this class and of later ones."
# undefended = "LEAK: the file was read."

# %% extra
import os
from pathlib import Path

try:
    print("LEAK:", Path("<<class>>/.autograder/secret").read_text())
except OSError:
    pass
for name, value in os.environ.items():
    if "SEED" in name or "SECRET" in name:
        print("LEAK:", name, value)
