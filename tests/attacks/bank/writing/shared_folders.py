# family = "writing"
# tries = "Files are left in every folder that other submissions may look into: /tmp, /var/tmp, /dev/shm, /run, the scratch folders of the workers."
# could_earn = "A message or a trap for another submission."
# undefended = "Without a box, the files were there afterwards."

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


for folder in ('/tmp', '/var/tmp', '/dev/shm', '/run', '/run/lock', os.getcwd() + '/../..', os.getcwd() + '/../../..'):
    write(Path(folder) / '<<mark>>', 'x')
