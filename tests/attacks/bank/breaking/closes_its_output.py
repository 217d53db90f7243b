# family = "breaking"
# assignment = "lab_1_1"
# tries = "The package installs a program ros2, which stands on the path before the course's: the first process of the box, which closes its output and sleeps."
# could_earn = "A batch that never ends: without output it was taken to have ended, and its exit code was waited for where nobody could end it any more."
# undefended = "A batch that takes 17 s went on until it was killed."

# %% solution files
<<silent_package>>
(folder / "ros2").write_text("#!/bin/sh\nexec sleep 100000 > /dev/null 2>&1\n")
(folder / "ros2").chmod(0o755)
setup = folder / "setup.py"
setup.write_text(setup.read_text().replace("data_files=[", "data_files=[\n        ('bin', ['ros2']),"))
