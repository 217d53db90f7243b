"""Functions that a Dask worker calls by name: bytes in, bytes out.

Without an import of its own, since the client process has to name these functions too, and is to hold little else.
"""

from __future__ import annotations


def offer_as_json(slots: int) -> bytes:
    """The worker's offer, as JSON of an :class:`autograder.grading.running.orders.Offer`.

    Args:
        slots: Notebooks at once: the threads that Dask gives it.
    """
    import msgspec

    from autograder.grading.cluster.start_worker import offer

    return msgspec.json.encode(offer(slots))


def execute_order(order: bytes) -> bytes:
    """Do an order; the execution as JSON.

    Args:
        order: An :class:`autograder.grading.running.orders.Order` as JSON.
    """
    from autograder.grading.cluster.dask_worker import execute

    return execute(order)
