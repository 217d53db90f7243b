"""The options of `topic echo` and `topic pub` for the quality of service."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import argparse

    from rclpy.node import Node
    from rclpy.qos import QoSProfile

# The short names of rclpy's policies and profiles. They are repeated here, because the help must not wait for the
# import of rclpy.
_PROFILES = (
    "unknown",
    "default",
    "system_default",
    "sensor_data",
    "services_default",
    "parameters",
    "parameter_events",
    "action_status_default",
    "best_available",
)
_HISTORY = ("system_default", "keep_last", "keep_all", "unknown")
_RELIABILITY = ("system_default", "reliable", "best_effort", "unknown", "best_available")
_DURABILITY = ("system_default", "transient_local", "volatile", "unknown", "best_available")
_LIVELINESS = ("system_default", "automatic", "manual_by_topic", "unknown", "best_available")


def add_qos_arguments(parser: argparse.ArgumentParser, verb: str, default: str) -> None:
    """Add the options for the quality of service.

    Args:
        parser: The parser of the verb.
        verb: The verb for the help: subscribe or publish.
        default: The short name of the profile that is used without options.
    """
    parser.add_argument(
        "--qos-profile",
        choices=_PROFILES,
        default=default,
        help=f"Quality of service preset profile to {verb} with (default: {default})",
    )
    parser.add_argument(
        "--qos-depth",
        metavar="N",
        type=int,
        help=f"Queue size setting to {verb} with (overrides depth value of --qos-profile option)",
    )
    for policy, choices in (
        ("history", _HISTORY),
        ("reliability", _RELIABILITY),
        ("durability", _DURABILITY),
        ("liveliness", _LIVELINESS),
    ):
        parser.add_argument(
            f"--qos-{policy}",
            choices=choices,
            help=f"Quality of service {policy} setting to {verb} with (overrides {policy} value of "
            "--qos-profile option)",
        )
    parser.add_argument(
        "--qos-liveliness-lease-duration-seconds",
        type=float,
        help=f"Quality of service liveliness lease duration setting to {verb} with (overrides liveliness "
        "lease duration value of --qos-profile option)",
    )


def _policy(kind: Any, short_name: str) -> Any:
    return kind.get_from_short_key(short_name)


def given_profile(args: argparse.Namespace) -> QoSProfile:
    """Return the profile that the options name."""
    from rclpy.duration import Duration
    from rclpy.qos import (
        QoSDurabilityPolicy,
        QoSHistoryPolicy,
        QoSLivelinessPolicy,
        QoSPresetProfiles,
        QoSReliabilityPolicy,
    )

    profile = QoSPresetProfiles.get_from_short_key(args.qos_profile)
    for policy, kind in (
        ("history", QoSHistoryPolicy),
        ("reliability", QoSReliabilityPolicy),
        ("durability", QoSDurabilityPolicy),
        ("liveliness", QoSLivelinessPolicy),
    ):
        if chosen := getattr(args, f"qos_{policy}"):
            setattr(profile, policy, _policy(kind, chosen))
    if args.qos_liveliness_lease_duration_seconds:
        profile.liveliness_lease_duration = Duration(seconds=args.qos_liveliness_lease_duration_seconds)
    if args.qos_depth:
        profile.depth = args.qos_depth
    elif profile.durability == QoSDurabilityPolicy.TRANSIENT_LOCAL and profile.depth == 0:
        profile.depth = 1
    return profile


def matching_profile(node: Node, args: argparse.Namespace, topic: str) -> QoSProfile:
    """Return the profile for a subscription: the one of the options, or else one that receives from all publishers."""
    from rclpy.qos import QoSDurabilityPolicy, QoSReliabilityPolicy

    profile = given_profile(args)
    policies = (
        "depth",
        "history",
        "reliability",
        "durability",
        "liveliness",
        "liveliness_lease_duration_seconds",
    )
    offered = [info.qos_profile for info in node.get_publishers_info_by_topic(topic)]
    if not offered or any(getattr(args, f"qos_{policy}") is not None for policy in policies):
        return profile
    for policy, strong, weak in (
        ("reliability", QoSReliabilityPolicy.RELIABLE, QoSReliabilityPolicy.BEST_EFFORT),
        ("durability", QoSDurabilityPolicy.TRANSIENT_LOCAL, QoSDurabilityPolicy.VOLATILE),
    ):
        count = sum(getattr(one, policy) == strong for one in offered)
        if 0 < count < len(offered):
            kind = type(strong).__name__
            print(
                f"Some, but not all, publishers are offering {kind}.{strong.name}. Falling back to "
                f"{kind}.{weak.name} as it will connect to all publishers"
            )
        setattr(profile, policy, strong if count == len(offered) else weak)
    return profile
