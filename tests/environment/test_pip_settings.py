"""uv fetches from where the user's pip does."""

from __future__ import annotations

from environment.pip_settings import as_uv_has_them


def test_an_index_and_a_folder_are_handed_on() -> None:
    options, variables = as_uv_has_them(
        "global.index-url='https://one.example/simple'\n"
        "global.extra-index-url='https://two.example/simple\\nfile:///three'\n"
        "install.find-links='/wheels'\n"
    )
    assert options == []
    assert variables == {
        "UV_DEFAULT_INDEX": "https://one.example/simple",
        "UV_INDEX": "https://two.example/simple file:///three",
        "UV_FIND_LINKS": "/wheels",
    }


def test_a_variable_of_the_user_counts_more_than_a_file() -> None:
    options, variables = as_uv_has_them(
        ":env:.index-url='https://env.example'\ninstall.index-url='https://install.example'\n"
        "global.index-url='https://global.example'\n:env:.cert='/ca.pem'\nglobal.proxy='http://proxy.example:3128'\n"
    )
    assert options == []
    assert variables == {
        "UV_DEFAULT_INDEX": "https://env.example",
        "SSL_CERT_FILE": "/ca.pem",
        "ALL_PROXY": "http://proxy.example:3128",
    }


def test_without_a_network_only_what_is_named_is_looked_at() -> None:
    assert "--no-index" in as_uv_has_them("global.no-index='true'\n")[0]
    assert "--no-index" not in as_uv_has_them("global.no-index='false'\n")[0]


def test_what_does_not_concern_fetching_is_left_out() -> None:
    assert as_uv_has_them("freeze.timeout='10'\nglobal.constraint='/c.txt'\nglobal.quiet='1'\n") == ([], {})
    assert as_uv_has_them("") == ([], {})
