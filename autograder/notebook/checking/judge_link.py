"""Connects a check with the judge: by messages over a socket, and by a ROS context on the judge's domain.

If no grader has started a judge process, this module starts one. Notebook and judge share only the definitions of the
messages (:mod:`autograder.messages.judge_messages`). The judge imports nothing from :mod:`autograder.notebook`, and
trusts nothing in the kernel, because a student can change everything there.

While a check runs, rclpy's default context is a new one on the judge's domain. A student's class calls
``super().__init__("talker_node")``, which uses rclpy's default context. So its node is made on the judge's domain,
apart from the nodes of the notebook's demonstrations.
"""

from __future__ import annotations

import atexit
import contextlib
import os
import secrets
import subprocess
import time
from typing import TYPE_CHECKING, Self

import rclpy
import rclpy.utilities
from rclpy.context import Context
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions

from autograder.command_name import COMMAND
from autograder.dds_discovery import DOMAIN_VARIABLE, UNNAMED, receivers_wait
from autograder.messages.json_lines import Hangup, Lines, NotUnderstood
from autograder.messages.judge_messages import SOCKET_VARIABLE, FromJudge
from autograder.notebook.nodes.background_nodes import destroy_nodes_on
from autograder.safe_files import HeldFolder
from course_runtime.python_child import python_child

if TYPE_CHECKING:
    from collections.abc import Sequence

    from autograder.messages.json_lines import Message

    Endpoint = Sequence[str]
    """An endpoint as the judge names it: its topic in the middleware, and the identifier of its reader or writer."""


MAX_TEXT = 4_000
"""The maximum length in characters of a text that is sent to the judge. A longer message would end the connection."""


class JudgeUnreachable(ConnectionError):
    """No judge can be reached."""


class JudgeLink:
    """The connection to the judge for one check. Any thread may send, but only one thread may receive."""

    def __init__(self) -> None:
        """Connect to the judge; start one if there is none.

        Raises:
            JudgeUnreachable: No judge is running, and none could be started.
        """
        path = os.environ.get(SOCKET_VARIABLE) or _own_judge().path()
        try:
            self._lines = Lines.to(path)
        except Hangup as error:
            raise JudgeUnreachable(f"the judge cannot be reached ({error})") from error

    def say(self, message: Message) -> None:
        """Send a message. If the judge has ended, do nothing; the next :meth:`hear` raises the error."""
        with contextlib.suppress(Hangup):
            self._lines.say(message)

    def hear(self) -> FromJudge:
        """Return the judge's next message.

        Raises:
            JudgeUnreachable: The judge has ended.
        """
        try:
            message: FromJudge = self._lines.hear(FromJudge)
        except (Hangup, NotUnderstood) as error:
            raise JudgeUnreachable("the judge ended before it reached a verdict") from error
        return message

    def close(self) -> None:
        """Close the connection."""
        self._lines.close()


class _OwnJudge:
    """The judge process of this kernel. It ends together with the kernel, because then its standard input is closed."""

    def __init__(self) -> None:
        self._folder = HeldFolder("autograder-judge-")
        self._socket = self._folder.path / f"{secrets.token_hex(8)}.socket"
        environment = {k: v for k, v in os.environ.items() if not k.startswith("RCUTILS_LOGGING")}
        judge = python_child("-m", "autograder.judge", "--socket", str(self._socket), environment=environment)
        self._process = judge.start(
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            # a new session, because an interrupt of the kernel must not reach the judge
            start_new_session=True,
        )
        self._pid = os.getpid()
        self._ready = False

    def path(self) -> str:
        """Return the path of the judge's socket once it listens.

        Raises:
            JudgeUnreachable: The judge did not start.
        """
        if not self._ready:
            assert self._process.stdout is not None
            self._ready = self._process.stdout.readline() == b"ready\n"
        if not self._ready or not self.alive:
            raise JudgeUnreachable(
                f"the judge did not start; `{COMMAND} doctor` in a terminal says what is missing"
            )
        return str(self._socket)

    @property
    def alive(self) -> bool:
        """True if the judge runs and was started by this process, not by a process from which this one was forked."""
        return self._pid == os.getpid() and self._process.poll() is None

    def stop(self) -> None:
        """End the process."""
        if self._process.stdin is not None:
            self._process.stdin.close()
        try:
            self._process.wait(timeout=2.0)
        except subprocess.TimeoutExpired:
            self._process.kill()
        self._folder.remove()


_own: _OwnJudge | None = None


def _own_judge() -> _OwnJudge:
    """Return this kernel's own judge. The first call starts it; a later call restarts a judge that has died."""
    global _own
    if _own is None or not _own.alive:
        _own = _OwnJudge()
        atexit.register(_own.stop)
    return _own


def warm_up() -> None:
    """Start this kernel's judge before the first check needs it. If a grader has started a judge, do nothing."""
    if not os.environ.get(SOCKET_VARIABLE):
        _own_judge()


_GLOBAL_EXECUTOR = "__executor"
"""The name of the variable in ``rclpy/__init__.py`` that contains rclpy's global executor."""
MEETING = 0.5
"""Time limit in seconds of wall time for discovering the judge. After that, the run begins anyway."""
MEETING_POLL = 0.002
"""Seconds to sleep between two tests of whether the judge has been discovered."""


class CheckContext:
    """Replaces rclpy's default context inside a ``with`` block.

    Args:
        domain_id: The judge's domain.
        keeper: The name of the node that keeps the check's participant alive. The judge ignores this node. The name
            begins with an underscore, so that ``ros2 node list`` hides the node.
    """

    def __init__(self, domain_id: int, keeper: str) -> None:
        self._domain_id = domain_id
        self._name = keeper
        self._usual: Context | None = None
        self._keeper: Node | None = None
        self.context = Context()

    def __enter__(self) -> Self:
        with rclpy.utilities.g_context_lock:
            self._usual = rclpy.utilities.g_default_context
        # rclpy.spin and similar functions use one global executor, which belongs to the first context that was spun.
        # Remove it, so that rclpy makes a new one for this context.
        self._usual_executor = getattr(rclpy, _GLOBAL_EXECUTOR, None)
        setattr(rclpy, _GLOBAL_EXECUTOR, None)
        # Processes that the subject starts, such as the ros2 command, inherit the judge's domain from this variable.
        self._usual_domain = os.environ.get(DOMAIN_VARIABLE)
        os.environ[DOMAIN_VARIABLE] = str(self._domain_id)
        return self

    def __exit__(self, *_: object) -> None:
        self._end()
        setattr(rclpy, _GLOBAL_EXECUTOR, self._usual_executor)
        self._put(self._usual)
        if self._usual_domain is None:
            os.environ.pop(DOMAIN_VARIABLE, None)
        else:
            os.environ[DOMAIN_VARIABLE] = self._usual_domain

    def ensure(self, *, fresh: bool) -> None:
        """Make a new context if ``fresh`` is true, or if the student's code has shut down the last one."""
        if fresh or not self.context.ok():
            self.renew()
        else:
            self._put(self.context)

    def renew(self) -> None:
        """Create a new context with a new DDS participant, and wait until it has discovered the judge.

        A participant exists only as long as it has a node (rmw_fastrtps). Two new participants need a fifth of a second
        to discover each other's endpoints; later endpoints are discovered within a millisecond. So a node that does
        nothing, the keeper, is made before the subject and stays for all runs.
        """
        self._end()
        self.context = Context()
        rclpy.init(
            args=["--ros-args", "--disable-external-lib-logs"],
            context=self.context,
            domain_id=self._domain_id,
            signal_handler_options=SignalHandlerOptions.NO,
        )
        self._put(self.context)
        with receivers_wait():
            self._keeper = Node(
                self._name,
                context=self.context,
                use_global_arguments=False,
                enable_rosout=False,
                start_parameter_services=False,
            )
        deadline = time.monotonic() + MEETING
        while len(self._keeper.get_node_names()) < 2 and time.monotonic() < deadline:
            time.sleep(MEETING_POLL)

    def sees(self, there: Sequence[Endpoint], gone: Sequence[Endpoint], within: float) -> bool:
        """Wait until this participant sees all endpoints in ``there`` and none in ``gone``; False at the time limit.

        An endpoint and its node are announced separately. For an endpoint in ``there``, both must be known.

        Args:
            there: Endpoints that the judge has created.
            gone: Endpoints that the judge has removed.
            within: The limit in seconds of wall time.
        """
        deadline = time.monotonic() + within
        while True:
            known = self._known({topic for topic, _ in [*there, *gone]})
            with_its_node = {end for end, node in known.items() if not node.startswith(UNNAMED)}
            if with_its_node.issuperset(map(tuple, there)) and known.keys().isdisjoint(map(tuple, gone)):
                return True
            if time.monotonic() > deadline:
                return False
            time.sleep(MEETING_POLL)

    def _known(self, topics: set[str]) -> dict[tuple[str, ...], str]:
        """Return the endpoints on these topics, each with the name of its node."""
        node = self._keeper
        assert node is not None
        return {
            (topic, bytes(info.endpoint_gid).hex()): info.node_name
            for topic in topics
            for infos in (node.get_publishers_info_by_topic, node.get_subscriptions_info_by_topic)
            for info in infos(topic, no_mangle=True)
        }

    def _end(self) -> None:
        """Destroy the nodes of the context, then the context.

        A node that outlives its context would keep its logger. A later node with the same name would use this logger,
        and log to a destroyed publisher ("Failed to publish log message to rosout").
        """
        keeper, self._keeper = self._keeper, None
        if keeper is not None:
            destroy_nodes_on(self.context)
        self.context.try_shutdown()

    @staticmethod
    def _put(context: Context | None) -> None:
        with rclpy.utilities.g_context_lock:
            rclpy.utilities.g_default_context = context  # type: ignore[assignment]
