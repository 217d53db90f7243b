"""Real nodes for the tests, on a domain of their own, and kernels to run cells in."""

from __future__ import annotations

import os
import queue
import subprocess
import sys
import threading
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import pytest
import rclpy
from jupyter_client.manager import KernelManager
from nbclient import NotebookClient
from nbformat.v4 import new_code_cell, new_notebook
from rclpy.node import Node
from std_msgs.msg import String

from autograder.dds_discovery import claim_free_domain
from autograder.notebook.nodes.background_nodes import stop_all
from autograder.notebook.nodes.ros_session import start_ros
from tests.cases import cases

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

LIMIT = 180.0
"""Seconds after which a test gives up waiting for an event that comes within milliseconds."""


class Ticker(Node):
    """Counts up on a topic, and tells a queue of each tick."""

    def __init__(self, name: str = "ticker", period: float = 0.005, topic: str = "ticks") -> None:
        super().__init__(name)
        self.ticks: queue.SimpleQueue[int] = queue.SimpleQueue()
        self.count = 0
        self.publisher = self.create_publisher(String, topic, 10)
        self.create_timer(period, self.tick)

    def tick(self) -> None:
        self.count += 1
        self.ticks.put(self.count)
        self.publisher.publish(String(data=str(self.count)))

    def wait_for_ticks(self, number: int = 3) -> None:
        """Wait for so many ticks from now on; an error where they do not come."""
        while not self.ticks.empty():
            self.ticks.get()
        for _ in range(number):
            self.ticks.get(timeout=LIMIT)


class Listener(Node):
    """Puts what it hears on a queue."""

    def __init__(self, name: str = "listener", topic: str = "ticks") -> None:
        super().__init__(name)
        self.heard: queue.SimpleQueue[str] = queue.SimpleQueue()
        self.create_subscription(String, topic, self.hear, 10)

    def hear(self, message: String) -> None:
        self.heard.put(message.data)


class Failing(Ticker):
    """Raises in each tick."""

    def tick(self) -> None:
        self.ticks.put(0)
        raise RuntimeError("no such robot")


@dataclass(frozen=True)
class Nodes:
    """The node classes, for tests to take from a fixture."""

    Ticker: type[Ticker] = Ticker
    Listener: type[Listener] = Listener
    Failing: type[Failing] = Failing


@pytest.fixture(scope="session")
def domain() -> Iterator[int]:
    """A domain that no other test run uses."""
    claim = claim_free_domain(range(70, 80))
    yield claim.domain
    claim.release()


@pytest.fixture
def ros(domain: int, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """ROS, up on the tests' domain; everything is ended afterwards."""
    monkeypatch.setenv("ROS_DOMAIN_ID", str(domain))
    start_ros()
    yield
    stop_all()
    rclpy.try_shutdown()
    assert spin_threads() == []


@pytest.fixture
def nodes() -> Nodes:
    return Nodes()


def spin_threads() -> list[threading.Thread]:
    return [thread for thread in threading.enumerate() if thread.name == "ros-spin"]


@pytest.fixture
def count_spin_threads() -> Callable[[], int]:
    """How many threads spin nodes just now."""
    return lambda: len(spin_threads())


@pytest.fixture
def until() -> Callable[[Callable[[], Any]], Any]:
    """Wait until something is true, and give it back."""

    def wait(condition: Callable[[], Any]) -> Any:
        woken = threading.Event()
        for _ in range(int(LIMIT / 0.005)):
            value = condition()
            if value:
                return value
            woken.wait(0.005)
        pytest.fail(f"never true: {condition}")

    return wait


@pytest.fixture
def graph(ros: None) -> Iterator[Node]:
    """A node that looks at the graph from a context of its own."""
    context = rclpy.Context()
    context.init(args=[], domain_id=int(os.environ["ROS_DOMAIN_ID"]))
    node = Node("observer", context=context)
    yield node
    node.destroy_node()
    context.shutdown()


@pytest.fixture
def run_script(domain: int) -> Callable[..., subprocess.CompletedProcess[str]]:
    """Run a program in a fresh interpreter, as a kernel is one."""

    def run(source: str, **environment: str | None) -> subprocess.CompletedProcess[str]:
        settings: dict[str, str | None] = {**os.environ, "ROS_DOMAIN_ID": str(domain), **environment}
        return subprocess.run(
            [sys.executable, "-c", source],
            env={name: value for name, value in settings.items() if value is not None},
            capture_output=True,
            text=True,
            timeout=180,
            check=False,
        )

    return run


@pytest.fixture
def as_in_a_notebook(domain: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Kernels that the test starts are on the tests' domain, and leave nothing out of their cells."""
    monkeypatch.setenv("ROS_DOMAIN_ID", str(domain))
    # With it, ipykernel leaves the output of compiled code, such as rclpy's log lines, out of the cells.
    monkeypatch.delenv("PYTEST_CURRENT_TEST")


@pytest.fixture
def run_cells(as_in_a_notebook: None) -> Callable[..., list[Any]]:
    """Run cells in a kernel of their own, with nbclient: what each shows in the end, after all updates of displays."""

    def run(*sources: str, allow_errors: bool = False) -> list[Any]:
        notebook = new_notebook(cells=[new_code_cell(source) for source in sources])
        # What one print says may come in two pieces, where the kernel has flushed in between; JupyterLab joins them.
        NotebookClient(
            notebook, timeout=LIMIT, allow_errors=allow_errors, kernel_name="python3", coalesce_streams=True
        ).execute()
        return [cell.outputs for cell in notebook.cells]

    return run


@pytest.fixture(scope="module")
def run_in_one_kernel(domain: int) -> Iterator[Callable[..., list[Any]]]:
    """As `run_cells`, but in one kernel for all tests of a file: each uses names of its own."""
    manager = KernelManager(kernel_name="python3")
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("ROS_DOMAIN_ID", str(domain))
        patch.delenv("PYTEST_CURRENT_TEST", raising=False)
        manager.start_kernel()

    def run(*sources: str, allow_errors: bool = False) -> list[Any]:
        notebook = new_notebook(cells=[new_code_cell(source) for source in sources])
        NotebookClient(
            notebook, manager, timeout=LIMIT, allow_errors=allow_errors, coalesce_streams=True
        ).execute()
        return [cell.outputs for cell in notebook.cells]

    yield run
    manager.shutdown_kernel(now=True)


@dataclass
class CellOutput:
    """What came out of one run of a cell."""

    stdout: str = ""
    stderr: str = ""
    value: str | None = None
    error: str | None = None
    traceback: str = ""


@dataclass
class Notebook:
    """A kernel, and cells to run in it as JupyterLab runs them."""

    manager: KernelManager
    client: Any
    _heard: list[Any] = field(default_factory=list)

    def run(self, source: str, cell: str | None = None) -> CellOutput:
        """Run a cell; ``cell`` is its id, as JupyterLab tells it to the kernel."""
        return self.result_of(self.begin(source, cell))

    def begin(self, source: str, cell: str | None = None) -> str:
        """Begin to run a cell without waiting for its end."""
        content = {
            "code": source,
            "silent": False,
            "store_history": True,
            "user_expressions": {},
            "allow_stdin": False,
            "stop_on_error": True,
        }
        metadata = {"cellId": cell} if cell else {}
        request = self.client.session.msg("execute_request", content, metadata=metadata)
        self.client.shell_channel.send(request)
        identity: str = request["header"]["msg_id"]
        return identity

    def interrupt(self) -> None:
        self.manager.interrupt_kernel()

    def wait_for_output(self, text: str) -> None:
        """Wait until something with this text has been printed; it is given out again with the result."""
        while not any(text in message["content"].get("text", "") for message in self._heard):
            self._heard.append(self.client.get_iopub_msg(timeout=LIMIT))

    def result_of(self, request: str) -> CellOutput:
        """Wait for the end of a cell."""
        output = CellOutput()
        while True:
            message = self._heard.pop(0) if self._heard else self.client.get_iopub_msg(timeout=LIMIT)
            kind, content = message["msg_type"], message["content"]
            if kind == "stream":
                setattr(output, content["name"], getattr(output, content["name"]) + content["text"])
            elif kind == "execute_result":
                output.value = content["data"]["text/plain"]
            elif kind == "error":
                output.error = f"{content['ename']}: {content['evalue']}"
                output.traceback = "\n".join(content["traceback"])
            elif kind == "status" and content["execution_state"] == "idle" and _answers(message, request):
                return output


def _answers(message: Any, request: str) -> bool:
    return bool(message["parent_header"].get("msg_id") == request)


NODE_CLASSES = cases(__file__, "NODE_CLASSES")


@pytest.fixture(scope="module")
def kernel(domain: int) -> Iterator[Notebook]:
    """A kernel that has the nodes of the course."""
    with _start_kernel(domain) as notebook:
        yield notebook


@pytest.fixture
def notebook(kernel: Notebook) -> Iterator[Notebook]:
    """The kernel with nothing spinning in it."""
    yield kernel
    assert kernel.run("stop_all(); rclpy.shutdown(); start_ros()").error is None


class _start_kernel:  # noqa: N801
    def __init__(self, domain: int) -> None:
        self._environment = {**os.environ, "ROS_DOMAIN_ID": str(domain)}
        # With it, ipykernel leaves the output of compiled code, such as rclpy's log lines, out of the cells.
        self._environment.pop("PYTEST_CURRENT_TEST", None)

    def __enter__(self) -> Notebook:
        self._manager = KernelManager(kernel_name="python3")
        self._manager.start_kernel(env=self._environment)
        self._client = self._manager.blocking_client()
        self._client.start_channels()
        self._client.wait_for_ready(timeout=LIMIT)
        notebook = Notebook(self._manager, self._client)
        first = notebook.run(NODE_CLASSES)
        assert first.error is None, first.traceback
        return notebook

    def __exit__(self, *exception: object) -> None:
        self._client.stop_channels()
        self._manager.shutdown_kernel()
