# family = "writing"
# tries = "A neighbour's submission is replaced by an empty one, another one's is removed."
# could_earn = "A better place in the class."
# undefended = "Without a box, the file was replaced."

# %% extra
import os
import sys
from pathlib import Path



def write(path, text):
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
        print("written", path)
    except OSError as error:
        print(type(error).__name__)


write(Path('<<class>>/submitted/honest_ada/lab_1_2/lab_1_2.ipynb'), '{}')
write(Path('<<class>>/submitted/honest_ben/<<mark>>'), 'x')
