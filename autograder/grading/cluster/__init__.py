"""Grading on a Dask cluster: the same tasks, executed by workers on other machines.

The grader decides which worker gets which task (running/task_dispatcher.py), and checks every answer
(running/worker_messages.py). The grader itself never imports Dask: a separate process (dask_client.py) communicates
with Dask. On the other machines, dask_worker.py executes a task in the same way as a local run.
"""
