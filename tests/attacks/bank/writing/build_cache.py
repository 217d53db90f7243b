# family = "writing"
# tries = "Finished builds are put into the cache, so that a neighbour's workspace of the same sources gets the attacker's programs."
# could_earn = "A neighbour's wrong grade, or code in a neighbour's box."
# undefended = "Without a box, the cache of the user could be written."

# %% extra
import os
import sys
from pathlib import Path

import platformdirs


def write(path, text):
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
        print("written", path)
    except OSError as error:
        print(type(error).__name__)


for folder in (platformdirs.user_cache_dir('ros2-course'), platformdirs.user_cache_dir('autograder'), '<<home>>/.cache'):
    write(Path(folder) / '<<mark>>', 'x')
write(Path('/var/tmp/<<mark>>'), 'x')
