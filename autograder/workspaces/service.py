"""The grader's service for checks of workspaces: it receives sources, builds them, runs programs and reports.

The service runs in the grader's executor, outside all boxes, and has two Unix sockets:

* The **judge's** socket, which the student's box cannot see. One connection is one check. The judge sends the sources
  that it got from the notebook. The service writes these into files, has them built, and runs the programs. It tells
  the judge what the workspace contains, how the build ended, which processes were started, and what the programs print.
* The **notebook's** socket, only for builds: `colcon build` in the student's box lets the service make the build.

The messages on both sockets are defined in :mod:`autograder.messages.workspaces`.
"""

from __future__ import annotations

import contextlib
import shutil
import socket
import threading
from dataclasses import dataclass
from typing import TYPE_CHECKING, Self

from autograder.messages import workspaces as messages
from autograder.messages.lines import Hangup, Lines, NotUnderstood, listen
from autograder.temporary_folders import fresh_folder
from autograder.workspaces.builds.artefacts import pack
from autograder.workspaces.builds.builds import BuildTookTooLong
from autograder.workspaces.builds.colcon import look
from autograder.workspaces.graded_builds import GradedBuilds
from autograder.workspaces.packages import WORKSPACE
from autograder.workspaces.session import Session
from autograder.workspaces.sources import BadSources, receive

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping
    from pathlib import Path

    from autograder.workspaces.builds.colcon import Build
    from autograder.workspaces.running.jobs import Jobs

MAX_BUILDS = 20
"""The maximum number of builds that one notebook may request. For later builds, colcon itself runs in the box."""
PIECE = 400_000
"""The maximum number of bytes of an archive in one message."""


@dataclass(frozen=True)
class ServiceSockets:
    """The paths of the sockets on which the service listens.

    Attributes:
        judge: The socket that only the judge's box sees.
        notebook: The socket that the student's box sees; None if the notebook cannot request builds.
    """

    judge: Path
    notebook: Path | None


class WorkspaceService:
    """The service for one submission. At the end of the ``with`` block, its builds and programs are ended.

    Args:
        sockets: The sockets to create, in existing folders.
        jobs: Runs builds and programs.
        builds: The folder for builds. No other process may use it.
        variables: More environment variables for programs, such as ROS settings.
        folder: A folder for sources that nothing else uses.
        ahead: The folder of builds made in advance; None if there is none.
    """

    def __init__(
        self,
        sockets: ServiceSockets,
        jobs: Jobs,
        builds: Path,
        variables: Mapping[str, str],
        folder: Path,
        ahead: Path | None = None,
    ) -> None:
        self._builds = GradedBuilds(builds, jobs, ahead)
        self._variables = variables
        self._folder = fresh_folder("sources-", folder)
        self._left = threading.Semaphore(MAX_BUILDS)
        self._conversations: set[Lines] = set()
        self._threads: list[threading.Thread] = []
        self._closing = threading.Event()
        self._listeners = [self._open(sockets.judge, self._serve_judge)]
        if sockets.notebook is not None:
            self._listeners.append(self._open(sockets.notebook, self._serve_notebook))

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Close all connections, and end their builds and programs."""
        self._closing.set()
        for listener in self._listeners:
            with contextlib.suppress(OSError):
                listener.shutdown(socket.SHUT_RDWR)
            listener.close()
        for conversation in list(self._conversations):
            conversation.close()
        for thread in self._threads:
            thread.join()
        shutil.rmtree(self._folder, ignore_errors=True)

    def _open(self, path: Path, serve: Callable[[Lines, Path], None]) -> socket.socket:
        listener = listen(path)
        thread = threading.Thread(target=self._accept, args=(listener, serve), daemon=True)
        self._threads.append(thread)
        thread.start()
        return listener

    def _accept(self, listener: socket.socket, serve: Callable[[Lines, Path], None]) -> None:
        """Serve connections one after the other, so that only one check and one build runs at a time."""
        while not self._closing.is_set():
            try:
                connection, _ = listener.accept()
            except OSError:
                return
            lines = Lines(connection)
            self._conversations.add(lines)
            if self._closing.is_set():
                lines.close()
                return
            folder = fresh_folder("c-", self._folder)
            try:
                serve(lines, folder)
            except Hangup:
                pass
            except Exception as error:
                with contextlib.suppress(Hangup):
                    lines.say(messages.Trouble(f"{type(error).__name__}: {error}"[:500]))
            finally:
                lines.close()
                self._conversations.discard(lines)
                shutil.rmtree(folder, ignore_errors=True)

    def _serve_judge(self, lines: Lines, folder: Path) -> None:
        with Session(lines, self._builds, self._variables, folder) as session:
            session.serve()

    def _serve_notebook(self, lines: Lines, folder: Path) -> None:
        """Answer one request for a build (:mod:`autograder.workspaces.builds.own_builds`)."""
        if not self._left.acquire(blocking=False):
            lines.say(messages.NotBuilt("this notebook has reached its maximum number of builds"))
            return
        try:
            order = lines.hear(messages.BuildRequest)
            receive(lines, order.count, order.path, folder)
        except (BadSources, NotUnderstood) as error:
            lines.say(messages.NotBuilt(str(error)))
            return
        made = look(folder / order.path)
        if not made.trouble:
            made = self._made(made, frozenset(order.only))
        if made.ok and made.install is not None:
            self._send(lines, made, made.install)
            return
        told = (text.replace(f"{folder}/", "") for text in (made.trouble, made.package, made.line, made.log))
        lines.say(messages.BuildFailed(made.seconds, *told))

    def _made(self, found: Build, names: frozenset[str]) -> Build:
        def targets(there: Build) -> list[str]:
            return [package.name for package in there.packages if package.name in names]

        try:
            return self._builds.build(found, targets, cancelled=self._closing.is_set)
        except BuildTookTooLong as error:
            return error.build

    def _send(self, lines: Lines, made: Build, install: Path) -> None:
        archive = pack(install)
        pieces = [archive[at : at + PIECE] for at in range(0, len(archive), PIECE)]
        place = self._builds.jobs.place(WORKSPACE, install.parent) / "install"
        lines.say(messages.BuildDone(len(pieces), str(place), made.seconds))
        for piece in pieces:
            lines.say(messages.Piece(piece))
