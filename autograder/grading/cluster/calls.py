"""Functions that a Dask worker calls by name: bytes in, bytes out.

It has no imports at the top, because the client process also imports it, and should load little else.
"""

from __future__ import annotations


def offer_as_json(slots: int) -> bytes:
    """Return the worker's offer, as JSON of an :class:`autograder.grading.running.orders.Offer`.

    Args:
        slots: The number of notebooks at once: the threads that Dask gives the worker.
    """
    import msgspec

    from autograder.grading.cluster.start_worker import offer

    return msgspec.json.encode(offer(slots))


def execute_order(order: bytes) -> bytes:
    """Execute an order, and return the execution as JSON.

    Args:
        order: An :class:`autograder.grading.running.orders.Order` as JSON.
    """
    from autograder.grading.cluster.dask_worker import execute

    return execute(order)
