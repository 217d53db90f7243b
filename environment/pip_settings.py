"""Converts pip's settings for uv, because uv installs the packages and does not read pip's configuration."""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Mapping

# The sections in the order in which pip reads them; the last one wins (pip's documentation, "Configuration").
_SECTIONS = ("global", "install", ":env:")
_OPTIONS = {
    "index-url": "--default-index",
    "extra-index-url": "--index",
    "find-links": "--find-links",
    "trusted-host": "--allow-insecure-host",
}
_VARIABLES = {
    "cert": "SSL_CERT_FILE",
    "client-cert": "SSL_CLIENT_CERT",
    "proxy": "ALL_PROXY",
    "default-timeout": "UV_HTTP_TIMEOUT",
    "timeout": "UV_HTTP_TIMEOUT",
}


def as_uv_has_them(listed: str) -> tuple[list[str], dict[str, str]]:
    """Return the options and variables with which uv downloads from the same place as pip.

    Args:
        listed: The output of ``pip config list``: on each line a section, a name and a quoted value.
    """
    settings = _settings(listed)
    options = [
        word
        for name, option in _OPTIONS.items()
        for value in settings.get(name, "").split()
        for word in (option, value)
    ]
    if settings.get("no-index", "").lower() in ("1", "true", "yes", "on"):
        options.append("--no-index")
    return options, {_VARIABLES[name]: value for name, value in settings.items() if name in _VARIABLES}


def _settings(listed: str) -> Mapping[str, str]:
    found: dict[str, dict[str, str]] = {section: {} for section in _SECTIONS}
    for line in listed.splitlines():
        key, _, value = line.partition("=")
        section, _, name = key.rpartition(".")
        if section in found:
            found[section][name] = str(ast.literal_eval(value))
    return {name: value for section in _SECTIONS for name, value in found[section].items()}
