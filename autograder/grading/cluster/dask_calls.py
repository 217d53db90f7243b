"""Functions that a Dask worker calls by name, with bytes as results.

All imports are inside the functions, because the client process also imports this module, and should load as little as
possible.
"""

from __future__ import annotations


def offer_as_json(slots: int) -> bytes:
    """Return the worker's offer, as JSON of an :class:`autograder.grading.running.worker_messages.Offer`.

    Args:
        slots: The number of notebooks that the worker executes at the same time: the number of its Dask threads.
    """
    import msgspec

    from autograder.grading.cluster.dask_worker import offer

    return msgspec.json.encode(offer(slots))


def execute_order(order: bytes) -> bytes:
    """Execute an order, and return the execution as JSON.

    Args:
        order: An :class:`autograder.grading.running.worker_messages.Order` as JSON.
    """
    from autograder.grading.cluster.dask_worker import execute

    return execute(order)
