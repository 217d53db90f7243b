"""Notebooks as the server of ``./course lab`` hands them to JupyterLab: not "unsaved" as soon as they are open.

A released notebook names no version of Python, since it is made once and opened with any. JupyterLab writes the
version of the kernel into each notebook that has none, or another one, and from then on there is something to save:
the mark of an unsaved notebook, and a question when it is closed, before the student has written a letter. So the
server puts the version in while it reads the file. The file itself stays as it is until the student saves.
"""

from __future__ import annotations

import sys
from typing import Any

from jupyter_server.services.contents.largefilemanager import AsyncLargeFileManager

VERSION = sys.version.split()[0]
"""The version of the kernel's language (``IPythonKernel.language_info``): it runs on the server's own Python."""


class OpenedNotebooks(AsyncLargeFileManager):
    """The usual files, and the kernel's version in the notebooks among them."""

    async def get(self, path: str, *args: Any, **options: Any) -> dict[str, Any]:
        """The server's answer about a file or folder, with the file's content where that is asked for."""
        model: dict[str, Any] = await super().get(path, *args, **options)  # type: ignore[no-untyped-call]
        content = model.get("content")
        if model["type"] == "notebook" and content is not None:
            language = content["metadata"].get("language_info", {})
            if language.get("name") == "python":
                language["version"] = VERSION
        return model
