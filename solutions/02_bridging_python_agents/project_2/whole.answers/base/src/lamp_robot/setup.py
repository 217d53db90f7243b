from setuptools import find_packages, setup

package_name = "lamp_robot"

setup(
    name=package_name,
    version="0.0.0",
    packages=find_packages(exclude=["test"]),
    data_files=[
        ("share/ament_index/resource_index/packages", ["resource/" + package_name]),
        ("share/" + package_name, ["package.xml"]),
        ("share/lamp_robot/launch", ["launch/lamp.launch.py"]),
    ],
    install_requires=["setuptools"],
    zip_safe=True,
    maintainer="The course",
    maintainer_email="course@example.com",
    description="A robot that goes where the lamp is on",
    license="Apache-2.0",
    entry_points={
        "console_scripts": [
            "bridge = lamp_robot.bridge:main",
            "safe_hands = lamp_robot.safe_hands:main",
        ],
    },
)
