"""The source of a YAML launch file."""

from launch.launch_description_sources import FrontendLaunchDescriptionSource

__all__ = ["YAMLLaunchDescriptionSource"]


class YAMLLaunchDescriptionSource(FrontendLaunchDescriptionSource):
    """A YAML launch file."""
