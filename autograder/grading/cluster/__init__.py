"""Grading on a Dask cluster: the same tasks, executed by workers on other machines.

The grader (connection.py, pool.py) decides who gets which task and believes nothing before it is admitted
(admission.py). A process of its own (dask_client.py) speaks with Dask. On the other side, worker.py executes a task
exactly as a local run does. Nothing here imports Dask into the grader.
"""
