"""The fork servers of the tests in this folder."""

from tests.boxes.fork_servers import boxed, unboxed

__all__ = ["boxed", "unboxed"]
