# family = "reading"
# assignment = "exercise_1_1"
# tries = "A launch file searches as the kernel does, and prints what it has found."
# could_earn = "As in the kernel, and the course's own talker and listener, which a launch file may start."
# undefended = "LEAK: as in the kernel."
# says = "SEARCHED by searches_in_a_launch: "

# %% solution files
from pathlib import Path

<<searches>>
Path("remap.launch.py").write_text(SEARCHES + """

from launch import LaunchDescription


def generate_launch_description():
    for line in search('searches_in_a_launch'):
        print(line, flush=True)
    return LaunchDescription([])
""")
