"""Lab 1.3, the interface: a package of one's own that generates a service type with the right fields."""

from __future__ import annotations

from autograder.kit import Draft, ServiceType

recipe = ServiceType("AddTwoInts.srv", "my_robot_interfaces")
interface = Draft(
    "lab_1_3.interface",
    "Lab 1.3 · The interface",
    "A package of your own that generates the service type AddTwoInts.",
    recipe,
)
interface.asks("fields", "Has the right fields", recipe.has_the_fields, points=3)
interface.asks("declares", "Names what it needs in package.xml", recipe.declares, points=1)
interface.asks("builds", "Builds and generates the type", recipe.builds, points=3)
interface.asks("wire", "Has the right type on the wire", recipe.is_on_the_wire, points=3)

EXERCISE = interface.exercise(
    limit=400.0,
    runner=recipe.runner,
    text={
        "The request of your service has two integers, first `a` and then `b`, and its response has one, `sum`. "
        "All three are `int64`": "fields wire",
        "Three lines make yours a package with interfaces:": "declares builds",
        "One point is for `package.xml`: it has to name what the package needs.": "declares",
        '`rosidl_generate_interfaces(${PROJECT_NAME} "FILE" ...)` generates the code.': "builds",
    },
    counts={
        "declares": "Another tag for the first two lines, such as `depend`, counts as well.",
    },
)
