"""``autograder worker``: looks at what it can offer, says so, and comes and goes cleanly."""

from __future__ import annotations

import importlib.util
import os
import shutil
import signal
import subprocess
import tempfile

import pytest
from click.testing import CliRunner
from dask_cluster import VERSION, DaskCluster

pytest.importorskip("distributed", reason="./course setup --with cluster installs it")

from typing import TYPE_CHECKING
from unittest.mock import Mock

from autograder.cli import cli
from autograder.grading.classes.class_directory import ClassDirectory, switch_sandbox_off
from autograder.grading.cluster import cluster_dispatcher, dask_worker
from autograder.grading.grading_errors import GradingError

if TYPE_CHECKING:
    from contextlib import AbstractContextManager
    from pathlib import Path

    from tiny_class import TinyClass

    from autograder.grading.running import execution_backends


def test_without_a_sandbox_it_does_not_start(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(dask_worker, "why_impossible", lambda: "bubblewrap is not installed")
    done = CliRunner().invoke(cli, ["worker", "tcp://127.0.0.1:1"])
    assert done.exit_code == 2
    assert "No sandbox is possible here: bubblewrap is not installed." in done.output
    assert "--unsafe-no-sandbox" in done.output


def test_without_an_address_it_says_how_to_give_one(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("DASK_SCHEDULER_ADDRESS", raising=False)
    done = CliRunner().invoke(cli, ["worker"])
    assert done.exit_code == 2
    assert "./course worker tcp://host:8786" in done.output


@pytest.mark.parametrize(
    "address", ["nonsense://x:1", "host:8786", "tcp://host", "tcp://a b:1", "-x", "tcp://h:1;x"]
)
def test_what_is_no_address_is_refused(address: str) -> None:
    done = CliRunner().invoke(cli, ["worker", "--", address])
    assert done.exit_code == 2
    assert "is not an address of a Dask scheduler. An address looks like tcp://host:8786" in done.output


def test_without_a_scheduler_it_says_so(monkeypatch: pytest.MonkeyPatch) -> None:

    monkeypatch.setattr(dask_worker, "_CONNECT_SECONDS", 0.5)
    monkeypatch.setattr(dask_worker, "why_impossible", lambda: "")
    done = CliRunner().invoke(cli, ["worker", "tcp://127.0.0.1:1"])
    assert done.exit_code == 2, done.output
    assert "No Dask scheduler answers at tcp://127.0.0.1:1" in done.output


def test_without_dask_it_says_how_to_get_it(monkeypatch: pytest.MonkeyPatch, tiny: TinyClass) -> None:
    find = importlib.util.find_spec
    monkeypatch.setattr(
        importlib.util, "find_spec", lambda name: None if name == "distributed" else find(name)
    )
    for words in (["worker", "tcp://x:1"], ["grade", str(tiny.path), "--scheduler", "tcp://x:1"]):
        done = CliRunner().invoke(cli, words)
        assert done.exit_code == 2
        assert "./course setup --with cluster" in done.output


def test_what_is_no_address_or_belongs_to_this_machine_is_refused_by_grade(tiny: TinyClass) -> None:
    done = CliRunner().invoke(cli, ["grade", str(tiny.path), "--scheduler", "host"])
    assert done.exit_code == 2
    assert "is not an address of a Dask scheduler" in done.output
    done = CliRunner().invoke(cli, ["grade", str(tiny.path), "--scheduler", "tcp://x:1", "--jobs", "2"])
    assert done.exit_code == 2
    assert "./course worker --jobs" in done.output


def test_it_says_what_it_offers_and_ends_when_it_is_told(tmp_path_factory: pytest.TempPathFactory) -> None:
    with DaskCluster() as cluster, cluster.worker("w", slots=3, version="v1", obstacle="") as process:
        process.send_signal(signal.SIGTERM)
        assert process.wait(timeout=180) == 0
    assert "w can execute 3 notebooks at the same time, in boxes, with course version v1." in cluster.said


@pytest.fixture
def certificates(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """One certificate for all, where Dask looks for its settings."""
    if shutil.which("openssl") is None:
        pytest.skip("there is no openssl to make a certificate with")
    key, certificate = tmp_path / "key.pem", tmp_path / "certificate.pem"
    subject = ["-subj", "/CN=localhost", "-days", "1", "-keyout", str(key), "-out", str(certificate)]
    subprocess.run(
        ["openssl", "req", "-x509", "-newkey", "rsa:2048", "-nodes", *subject],
        check=True,
        capture_output=True,
    )
    monkeypatch.setenv("DASK_DISTRIBUTED__COMM__TLS__CA_FILE", str(certificate))
    for part in ("SCHEDULER", "WORKER", "CLIENT"):
        monkeypatch.setenv(f"DASK_DISTRIBUTED__COMM__TLS__{part}__CERT", str(certificate))
        monkeypatch.setenv(f"DASK_DISTRIBUTED__COMM__TLS__{part}__KEY", str(key))


@pytest.mark.usefixtures("certificates")
def test_with_certificates_all_speak_tls_and_who_has_none_stays_outside(
    monkeypatch: pytest.MonkeyPatch, tiny: TinyClass
) -> None:
    monkeypatch.setattr(cluster_dispatcher, "course_version", lambda: VERSION)
    switch_sandbox_off(tiny.path)
    directory = ClassDirectory(tiny.path)
    told: list[str] = []

    def connected(address: str) -> AbstractContextManager[execution_backends.Execute]:
        return cluster_dispatcher.on_cluster(directory, address, "a:B", told.append)

    with DaskCluster("tls") as cluster, cluster.worker("w"):
        assert cluster.address.startswith("tls://")
        with connected(cluster.address) as execute:
            assert list(execute(())) == []
            assert told == []
        with (
            pytest.raises(GradingError, match="cannot be reached"),
            connected(cluster.address.replace("tls", "tcp")),
        ):
            pass
        monkeypatch.delenv("DASK_DISTRIBUTED__COMM__TLS__CLIENT__CERT")
        with pytest.raises(GradingError, match="cannot be reached"), connected(cluster.address):
            pass


def test_it_ends_when_the_scheduler_does() -> None:
    with DaskCluster() as cluster, cluster.worker("w") as process:
        cluster.scheduler.kill()
        assert process.wait(timeout=180) == 0
        assert process.stdout
        assert "the scheduler at" in process.stdout.read()


def test_its_folder_is_its_own_whatever_another_user_has_put_there(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    guessed = tmp_path / f"autograder-{os.getuid()}-{os.getpid()}"
    guessed.mkdir(mode=0o777)
    given: list[Path] = []

    class FakeExecutor:
        def __init__(self, scratch: Path) -> None:
            given.append(scratch)

        def execute(self, key: str, data: bytes) -> bytes:
            return data

        def stop(self) -> None: ...

    monkeypatch.setattr(dask_worker, "_orders", None)
    monkeypatch.setattr(dask_worker, "Executor", FakeExecutor)
    monkeypatch.setattr(dask_worker, "get_worker", Mock)
    assert [dask_worker.execute(b"one"), dask_worker.execute(b"two")] == [b"one", b"two"]
    (scratch,) = given
    assert scratch.parent == tmp_path
    assert not scratch.is_relative_to(guessed)
    assert scratch.stat().st_mode & 0o777 == 0o700
    assert dask_worker._orders
    dask_worker._orders.teardown(Mock())
    assert list(tmp_path.iterdir()) == [guessed]
