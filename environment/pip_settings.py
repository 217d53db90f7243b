"""Converts pip's settings for uv, because uv installs the packages and does not read pip's configuration."""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Mapping

# The sections in the order in which pip reads them; the last one wins (pip's documentation, "Configuration").
_SECTIONS = ("global", "install", ":env:")
_VARIABLES = {
    "index-url": "UV_DEFAULT_INDEX",
    "extra-index-url": "UV_INDEX",
    "find-links": "UV_FIND_LINKS",
    "trusted-host": "UV_INSECURE_HOST",
    "cert": "SSL_CERT_FILE",
    "client-cert": "SSL_CLIENT_CERT",
    "proxy": "ALL_PROXY",
    "default-timeout": "UV_HTTP_TIMEOUT",
    "timeout": "UV_HTTP_TIMEOUT",
}
_SEPARATORS = {"UV_INDEX": " ", "UV_FIND_LINKS": ",", "UV_INSECURE_HOST": " "}


def as_uv_has_them(listed: str) -> tuple[list[str], dict[str, str]]:
    """Return the options and variables with which uv downloads from the same place as pip.

    Addresses are variables, because they may contain a password. Options are shown by the log of the set-up, and to
    every user of the machine.

    Args:
        listed: The output of ``pip config list``: on each line a section, a name and a quoted value.
    """
    settings = _settings(listed)
    variables = {
        variable: _SEPARATORS[variable].join(value.split()) if variable in _SEPARATORS else value
        for name, value in settings.items()
        if (variable := _VARIABLES.get(name))
    }
    is_without = settings.get("no-index", "").lower() in ("1", "true", "yes", "on")
    return ["--no-index"] if is_without else [], variables


def _settings(listed: str) -> Mapping[str, str]:
    found: dict[str, dict[str, str]] = {section: {} for section in _SECTIONS}
    for line in listed.splitlines():
        key, _, value = line.partition("=")
        section, _, name = key.rpartition(".")
        if section in found:
            found[section][name] = str(ast.literal_eval(value))
    return {name: value for section in _SECTIONS for name, value in found[section].items()}
