"""Translates the names of the kit for quality of service into rclpy's profiles, and back."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy

from autograder.kit.counterparts import Qos

if TYPE_CHECKING:
    from collections.abc import Mapping


_POLICIES = {
    Qos.DEFAULT: (ReliabilityPolicy.RELIABLE, DurabilityPolicy.VOLATILE),
    Qos.SENSOR: (ReliabilityPolicy.BEST_EFFORT, DurabilityPolicy.VOLATILE),
    Qos.LATCHED: (ReliabilityPolicy.RELIABLE, DurabilityPolicy.TRANSIENT_LOCAL),
}


def profile(qos: Qos, depth: int = 10) -> QoSProfile:
    """Return the profile of this name, with a queue of this depth."""
    reliability, durability = _POLICIES[qos]
    return QoSProfile(depth=depth, reliability=reliability, durability=durability)


def qos_of(policies: Mapping[str, int]) -> Qos:
    """Return the name of an endpoint's policies, as the ROS graph shows them. The queue's depth is not on the graph.

    An endpoint that is both best effort and transient local counts as best effort, because most subscribers lose by it.
    """
    if policies["reliability"] == ReliabilityPolicy.BEST_EFFORT:
        return Qos.SENSOR
    return Qos.LATCHED if policies["durability"] == DurabilityPolicy.TRANSIENT_LOCAL else Qos.DEFAULT
