"""The source of an XML launch file."""

from launch.launch_description_sources import FrontendLaunchDescriptionSource

__all__ = ["XMLLaunchDescriptionSource"]


class XMLLaunchDescriptionSource(FrontendLaunchDescriptionSource):
    """An XML launch file."""
