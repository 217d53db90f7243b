"""Grading on a Dask cluster: the same tasks, executed by workers on other machines.

The grader (connection.py, running/dispatcher.py) decides which worker gets which task, and uses no answer before it
is admitted (running/admission.py). A separate process (dask_client.py) communicates with Dask. On the other machines,
dask_worker.py executes a task exactly as a local run does. The grader itself never imports Dask.
"""
