"""What the process that forks kernels imports beforehand. It skips what is missing, so only a test finds that."""

from __future__ import annotations

import importlib

from autograder.execution import kernel_process


def test_every_module_and_function_of_the_course_that_is_loaded_beforehand_exists() -> None:
    for name in (*kernel_process._PRELOADED, kernel_process._MAGIC):
        if name.startswith("autograder."):
            importlib.import_module(name)
    for name, function in kernel_process._PREPARED:
        assert callable(getattr(importlib.import_module(name), function))
