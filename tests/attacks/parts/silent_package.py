# A package that builds, and whose program prints a word and sleeps.
import time
from pathlib import Path

folder = Path("ros2_ws/src/my_robot_pkg")
(folder / "my_robot_pkg").mkdir(parents=True)
(folder / "resource").mkdir()
(folder / "resource/my_robot_pkg").write_text("")
(folder / "my_robot_pkg/__init__.py").write_text("")
(folder / "my_robot_pkg/simple_node.py").write_text(
    "import time\n\n\ndef main():\n    print('.', flush=True)\n    time.sleep(3)\n"
)
(folder / "setup.cfg").write_text(
    "[develop]\nscript_dir=$base/lib/my_robot_pkg\n[install]\ninstall_scripts=$base/lib/my_robot_pkg\n"
)
(folder / "setup.py").write_text("""
from setuptools import find_packages, setup

setup(
    name="my_robot_pkg",
    version="0.0.0",
    packages=find_packages(),
    data_files=[
        ("share/ament_index/resource_index/packages", ["resource/my_robot_pkg"]),
        ("share/my_robot_pkg", ["package.xml"]),
    ],
    entry_points={"console_scripts": ["simple_node = my_robot_pkg.simple_node:main"]},
)
""")
(folder / "package.xml").write_text("""<?xml version="1.0"?>
<package format="3">
  <name>my_robot_pkg</name>
  <version>0.0.0</version>
  <description>Nothing</description>
  <maintainer email="you@example.com">Your name</maintainer>
  <license>Apache-2.0</license>
  <depend>rclpy</depend>
  <export><build_type>ament_python</build_type></export>
</package>
""")
