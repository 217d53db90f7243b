# family = "writing"
# tries = "Tasks are left for the system to start later: cron, systemd, at, profile scripts, ld.so.preload."
# could_earn = "Code as root, later."
# undefended = "As root without a box, every one of them could be written; run here without the system's own folders."
# boxed_only = true

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


for path in ('/etc/cron.d/<<mark>>', '/var/spool/cron/crontabs/<<mark>>', '/etc/profile.d/<<mark>>.sh'):
    write(Path(path), '# harmless\n')
