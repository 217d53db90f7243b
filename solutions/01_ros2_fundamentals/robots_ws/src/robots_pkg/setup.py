from setuptools import find_packages, setup

package_name = "robots_pkg"

setup(
    name=package_name,
    version="0.0.0",
    packages=find_packages(exclude=["test"]),
    data_files=[
        ("share/ament_index/resource_index/packages", ["resource/" + package_name]),
        ("share/" + package_name, ["package.xml"]),
    ],
    install_requires=["setuptools"],
    zip_safe=True,
    maintainer="The course",
    maintainer_email="course@example.com",
    description="A driver, and the wheels of a robot",
    license="MIT",
    entry_points={
        "console_scripts": [
            "driver = robots_pkg.driver:main",
            "wheels = robots_pkg.wheels:main",
        ],
    },
)
