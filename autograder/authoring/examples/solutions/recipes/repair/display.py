"""A display that stays dark, which students repair. `_display` judges it; an exercise that exists can do so, too."""

from autograder.kit.hunts.repairs import Repairs

EXERCISE = Repairs(
    "repair.display",
    "A repair · The dark display",
    "Repair the display, so that it shows each number of the sensor.",
    "repair._display",
    cause="The display subscribed to a topic on which nothing is published. ROS 2 does not report a misspelt name.",
).exercise()
