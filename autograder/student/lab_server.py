"""Serves the course page of ``./course lab``, and serves notebooks so that opening one does not mark it as unsaved.

The configuration in ``lab_config/`` turns this on. The page works even without JupyterLab's side panel.

A released notebook contains no version of Python, because it is opened with any version. JupyterLab would insert the
kernel's version and mark the notebook as unsaved, before the student has changed anything. So the server inserts the
version when it reads the file. The file itself stays unchanged until the student saves.
"""

from __future__ import annotations

import asyncio
import json
import os
import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

from jupyter_server.auth.decorator import authorized
from jupyter_server.base.handlers import JupyterHandler
from jupyter_server.services.contents.largefilemanager import AsyncLargeFileManager
from jupyter_server.utils import url_path_join
from nbgrader.server_extensions.validate_assignment.handlers import ValidateAssignmentHandler
from tornado import web

from autograder import check_journal, course, exercises
from autograder.check_journal import JournalEntry
from autograder.student.lab import COURSE_PAGE
from autograder.student.notebook_reset import CannotReset, reset
from autograder.student.progress import Standing, page_html, standing, trouble_html
from course_runtime.python_child import python_child

if TYPE_CHECKING:
    from jupyter_server.serverapp import ServerApp


class _CourseHandler(JupyterHandler):
    auth_resource = "contents"
    _track_activity = False
    """False: requests do not count as activity, because an open page asks for its points again and again, and must not
    keep an idle server alive.
    """

    @property
    def _notebooks(self) -> Path:
        """The folder that JupyterLab shows."""
        return Path(self.settings["server_root_dir"]).expanduser()

    @property
    def _journal(self) -> Path:
        """The path of the journal for the folder that JupyterLab shows."""
        named = os.environ.get(check_journal.VARIABLE)
        return Path(named) if named else check_journal.journal_path(self._notebooks)

    def _standing(self) -> Standing:
        """The progress of the student."""
        return standing(course.root(), self._notebooks, check_journal.entries(self._journal))

    def _name_in_body(self) -> str:
        """Return the notebook that a request names.

        Raises:
            HTTPError: The request does not name a notebook.
        """
        try:
            name = json.loads(self.request.body)["notebook"]
        except (ValueError, TypeError, KeyError):
            name = None
        if not isinstance(name, str):
            raise web.HTTPError(400, reason="a request names its notebook")
        return name


class _CoursePage(_CourseHandler):
    """The course page."""

    @web.authenticated
    @authorized
    async def get(self) -> None:
        """Show the page."""
        try:
            found = await asyncio.to_thread(self._standing)
            text = page_html(found, self.base_url, self.xsrf_token.decode())
        except (course.NoCourse, course.BrokenChapter, exercises.BrokenExercise, OSError) as error:
            self.set_status(500)
            text = trouble_html(str(error), self.base_url)
        self.set_header("Cache-Control", "no-cache")
        self.finish(text)


class _ReadMark(_CourseHandler):
    """Marks a notebook as read, or removes the mark."""

    @web.authenticated
    @authorized
    async def put(self) -> None:
        """Mark the notebook as read."""
        self._note("read")

    @web.authenticated
    @authorized
    async def delete(self) -> None:
        """Mark the notebook as unread."""
        self._note("unread")

    def _note(self, kind: Any) -> None:
        if not check_journal.note(JournalEntry(kind, self._name_in_body(), time.time()), self._journal):
            raise web.HTTPError(500, reason="the journal cannot be written")
        self.set_status(204)


class _ResetNotebook(_CourseHandler):
    """Resets a notebook."""

    @web.authenticated
    @authorized
    async def post(self) -> None:
        """Copy the student's notebook, and put the released notebook in its place. Send the name of the copy.

        The name is empty if the student's notebook did not exist, or was unchanged.
        """
        name = self._name_in_body()
        try:
            done = await asyncio.to_thread(reset, course.root(), self._notebooks, name, self._journal)
        except (CannotReset, course.NoCourse, course.BrokenChapter) as error:
            self.set_status(409)
            self.finish({"message": str(error)})
            return
        self.finish({"copy": done.copy.name if done.copy else ""})


class _Certificate(_CourseHandler):
    """Serves the certificate of a chapter as a file."""

    @web.authenticated
    @authorized
    async def get(self, name: str) -> None:
        """Send the certificate."""
        found = await asyncio.to_thread(self._standing)
        for chapter in found.chapters:
            if chapter.name == name and chapter.certificate is not None:
                self.set_header("Content-Type", "image/svg+xml")
                self.set_header("Content-Disposition", f'attachment; filename="certificate-{name}.svg"')
                self.finish(chapter.certificate.svg())
                return
        raise web.HTTPError(404, reason="this certificate does not exist yet")


class _Validation(_CourseHandler):
    """Tells how far nbgrader's *Validate* is."""

    @web.authenticated
    @authorized
    async def get(self) -> None:
        """Send the number of the running cell, 0 before the first; nothing if the notebook is not validated."""
        self.finish(self.settings.get(_PROGRESS, {}).get(self.get_query_argument("notebook"), {}))


_PROGRESS = "course_validation"
"""The setting of the server that contains the progress of each notebook that is validated, by its path."""
_MAX_ANSWER = 10_000_000
"""The maximum length of nbgrader's answer in bytes."""


@web.authenticated
async def _validate(handler: ValidateAssignmentHandler) -> None:
    """Validate a notebook in a process of its own, so that the server can tell how far it is."""
    # JupyterLab's toolbar sends the path as an argument, and the list of assignments sends it as JSON.
    notebook = handler.get_argument("path", None) or json.loads(handler.request.body)["path"]
    command = python_child("-m", "autograder.student.validation", str(handler.root_dir), notebook).command
    progress = handler.settings.setdefault(_PROGRESS, {})
    progress[notebook] = said = {"at": 0}
    process = await asyncio.create_subprocess_exec(
        *command, stdin=asyncio.subprocess.DEVNULL, stdout=asyncio.subprocess.PIPE, limit=_MAX_ANSWER
    )
    assert process.stdout is not None
    try:
        async for line in process.stdout:
            progress[notebook] = said = json.loads(line)
    finally:
        del progress[notebook]
    ended = {"success": False, "value": "Validate ended before the last cell. Try again."}
    handler.finish(json.dumps(said.get("answer", ended)))


VERSION = sys.version.split()[0]
"""The version of the kernel's language (``IPythonKernel.language_info``), which is the version of the server's own
Python.
"""


class OpenedNotebooks(AsyncLargeFileManager):
    """The usual file manager, which in addition inserts the kernel's version when it reads a notebook."""

    async def get(self, path: str, *args: Any, **options: Any) -> dict[str, Any]:
        """Return the model of a file or folder, with the file's content if that is requested."""
        model: dict[str, Any] = await super().get(path, *args, **options)  # type: ignore[no-untyped-call]
        # Change only notebooks of the usual form, not those that are damaged or come from another program.
        match model:
            case {
                "type": "notebook",
                "content": {"metadata": {"language_info": {"name": "python"} as language}},
            }:
                language["version"] = VERSION
        return model


def _jupyter_server_extension_points() -> list[dict[str, str]]:
    return [{"module": __name__}]


def _load_jupyter_server_extension(server: ServerApp) -> None:
    _tell_the_address_last(server)
    ValidateAssignmentHandler.post = _validate
    base = url_path_join(server.web_app.settings["base_url"], COURSE_PAGE)
    server.web_app.add_handlers(  # type: ignore[no-untyped-call]
        ".*$",
        [
            (f"{base}/?", _CoursePage),
            (f"{base}/read", _ReadMark),
            (f"{base}/reset", _ResetNotebook),
            (f"{base}/validation", _Validation),
            (f"{base}/certificate/([A-Za-z0-9_.-]+)\\.svg", _Certificate),
        ],
    )


_THIS_MACHINE = ("", "localhost", "127.0.0.1", "::1")
_RUNS = """
JupyterLab runs. Keep this terminal open; press Ctrl-C twice in it to end JupyterLab.
If no page has opened in your browser, open this address:"""


def _tell_the_address_last(server: ServerApp) -> None:
    """Print the address after everything has started, and leave out the server's own lines about the address.

    If other machines can reach the server, Jupyter's own lines are kept, because they contain its network address.
    """

    def tell() -> None:
        print(f"{_RUNS}\n\n{server.local_url}", file=sys.stderr, flush=True)

    if server.ip not in _THIS_MACHINE:
        return
    server.log.addFilter(lambda record: server.local_url not in record.getMessage())
    server.io_loop.add_callback(tell)
