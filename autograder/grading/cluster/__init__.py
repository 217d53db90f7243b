"""Grading on a Dask cluster: the same tasks, executed by workers on other machines.

The door is cluster_dispatcher.py: it decides which worker gets tasks, beside the rules that hold on one machine, too
(running/task_dispatcher.py). Every answer is checked (running/worker_messages.py). The grader itself never imports
Dask: a separate process (dask_client.py) communicates with Dask. On the other machines, dask_worker.py executes a task
in the same way as a local run.
"""
