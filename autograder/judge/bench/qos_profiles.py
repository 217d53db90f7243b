"""Translates the names of the kit for quality of service into rclpy's profiles, and back."""

from __future__ import annotations

from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy

from autograder.kit.counterparts import Qos

_POLICIES = {
    Qos.DEFAULT: (ReliabilityPolicy.RELIABLE, DurabilityPolicy.VOLATILE),
    Qos.SENSOR: (ReliabilityPolicy.BEST_EFFORT, DurabilityPolicy.VOLATILE),
    Qos.LATCHED: (ReliabilityPolicy.RELIABLE, DurabilityPolicy.TRANSIENT_LOCAL),
}


def profile(qos: Qos, depth: int = 10) -> QoSProfile:
    """Return the profile of this name, with a queue of this depth."""
    reliability, durability = _POLICIES[qos]
    return QoSProfile(depth=depth, reliability=reliability, durability=durability)


def qos_of(profile: QoSProfile) -> Qos:
    """Return the name of an endpoint's profile, as the ROS graph shows it. The depth of the queue is not on the graph.

    An endpoint that is both best effort and transient local counts as best effort, because most subscribers lose by it.
    """
    if profile.reliability is ReliabilityPolicy.BEST_EFFORT:
        return Qos.SENSOR
    return Qos.LATCHED if profile.durability is DurabilityPolicy.TRANSIENT_LOCAL else Qos.DEFAULT
