"""``python -m benchmarks.live_pictures``: what an idle notebook costs whose robot and whose live graph are open.

Starts a kernel as JupyterLab does, has it show the robot and the live graph, lets it stand still, and counts the CPU
seconds of the kernel with all its processes: 60 seconds after the pictures were first shown, and for 60 seconds.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
import time
from dataclasses import dataclass

import psutil
from jupyter_client.manager import KernelManager

from autograder.student.lab import join_domain

MOST = 3.0
"""Percent of a core that robot and graph may cost while nothing happens."""
READY = 180.0
"""Seconds that a cell may take."""
CELLS = {
    "a kernel with ROS": "from autograder.notebook import start_robot, start_ros, watch_graph\nstart_ros()",
    "and the robot": "robot = start_robot()",
    "and the live graph": "graph = watch_graph(minutes=60)",
}
"""What is opened one after the other, and the cell that does it."""
GOES_ON = "assert graph.running and robot is not None"


@dataclass(frozen=True)
class Cost:
    """The costs of the pictures that were open.

    Attributes:
        what: In words.
        percent: Of one core.
    """

    what: str
    percent: float


def cpu_seconds(pid: int) -> float:
    """What a process and all its descendants have used so far, those that have ended and were waited for included."""
    process = psutil.Process(pid)
    found = [process, *process.children(recursive=True)]
    total = 0.0
    for one in found:
        try:
            used = one.cpu_times()
        except psutil.NoSuchProcess:
            continue
        total += used.user + used.system + used.children_user + used.children_system
    return total


def measure(seconds: float) -> list[Cost]:
    """Open one thing after the other, and measure after each.

    Args:
        seconds: How long each is measured, and how long it is left alone before that.

    Raises:
        RuntimeError: A cell failed.
    """
    claim = join_domain()
    manager = KernelManager(kernel_name="python3")
    manager.start_kernel(stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    costs = []
    try:
        client = manager.blocking_client()
        client.start_channels()
        client.wait_for_ready(timeout=READY)
        pid = getattr(manager.provisioner, "pid", 0)
        for what, cell in CELLS.items():
            _run(client, cell)
            time.sleep(seconds)
            before, began = cpu_seconds(pid), time.monotonic()
            time.sleep(seconds)
            used = cpu_seconds(pid) - before
            costs.append(Cost(what, 100 * used / (time.monotonic() - began)))
        _run(client, GOES_ON)
        client.stop_channels()
    finally:
        manager.shutdown_kernel(now=True)
        if claim:
            claim.release()
    return costs


def _run(client: object, cell: str) -> None:
    reply = client.execute_interactive(cell, timeout=READY, output_hook=lambda _: None)  # type: ignore[attr-defined]
    if reply["content"]["status"] != "ok":
        raise RuntimeError(f"{cell!r} failed: {reply['content'].get('evalue')}")


def main() -> int:
    """Measure and print; return 1 if an idle notebook with robot and graph costs too much."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.live_pictures", description=__doc__)
    parser.add_argument("--seconds", type=float, default=60.0, help="how long each is measured")
    costs = measure(parser.parse_args().seconds)
    print("| open | of one core |", "| --- | --- |", sep="\n")
    for cost in costs:
        print(f"| {cost.what} | {cost.percent:.1f}% |")
    return int(costs[-1].percent >= MOST)


if __name__ == "__main__":
    sys.exit(main())
