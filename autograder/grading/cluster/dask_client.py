"""A process that communicates with a Dask cluster for the grader.

The standard input is a socket, over which the process exchanges lines of JSON with the grader.

There are four reasons for a separate process. First, Dask's client unpickles messages from workers, and pickles can run
code; in this process they cannot (inert_pickle.py). Second, this process can have a memory limit, which stops an answer
that is too large. Third, the grader stays free of Dask's threads and event loop. Fourth, if this process is killed, the
scheduler cancels all tasks that this process gave it.

The process reads no files of the class. It only passes orders to the workers that the grader names, and reports to the
grader the answers and which workers have joined or left.
"""

from __future__ import annotations

from autograder.grading.cluster import inert_pickle

inert_pickle.install()

import asyncio  # noqa: E402  (modules that import pickle from here on get the harmless one)
import contextlib  # noqa: E402
import logging  # noqa: E402
import resource  # noqa: E402
import sys  # noqa: E402
import uuid  # noqa: E402
from typing import Any  # noqa: E402

import msgspec  # noqa: E402
from distributed import Client, wait  # noqa: E402

from autograder.grading.cluster import dask_calls  # noqa: E402
from autograder.grading.running.worker_messages import (  # noqa: E402
    LARGEST_ANSWER,
    Answered,
    Asked,
    Broken,
    Command,
    Failed,
    Give,
    Joined,
    Left,
    News,
    Unfit,
)
from autograder.messages.json_lines import Hangup, Lines  # noqa: E402

_MEMORY = 3 << 30
"""The limit of this process's address space, in bytes, of which Python and Dask take 0.2 GB."""
_CONNECT_SECONDS = 10
_OFFER_SECONDS = 60.0
"""Time limit in seconds for a worker's offer. Before the offer, the worker tries to make a box, which can take a
second.
"""
_LINK_SECONDS = 5.0
"""If the scheduler has reported nothing for this many seconds, the connection to it is checked."""


def main(address: str) -> None:
    """Pass on orders and answers until the grader closes the connection or the scheduler ends.

    Args:
        address: The scheduler's address, such as ``tcp://host:8786``.
    """
    resource.setrlimit(resource.RLIMIT_AS, (_MEMORY, _MEMORY))
    logging.disable(logging.CRITICAL)
    grader = Lines.with_parent()
    asyncio.run(_serve(address, grader))


async def _serve(address: str, grader: Lines) -> None:
    try:
        client = await Client(
            address,
            asynchronous=True,
            deserializers=["msgpack"],  # makes workers send plain bytes instead of pickles
            timeout=_CONNECT_SECONDS,
            name="autograder",
        )
    except (OSError, ValueError, TypeError, TimeoutError) as error:
        _tell(grader, Broken(_first_line(error)))
        return
    await _Carrier(client, grader).serve()
    with contextlib.suppress(Exception):
        client.unsubscribe_topic("all")
        await client.close(timeout=1)
    grader.close()  # this ends the thread that listens to the grader


class _Carrier:
    def __init__(self, client: Any, grader: Lines) -> None:
        self._client, self._grader = client, grader
        self._batch = uuid.uuid4().hex[:12]
        self._workers: set[str] = set()
        self._given: dict[int, tuple[str, Any]] = {}
        """The worker and the future of each order without an answer."""
        self._running: set[asyncio.Task[None]] = set()
        self._changed = asyncio.Event()

    async def serve(self) -> None:
        """Carry out commands and report workers until the connection to the grader or to the scheduler ends."""
        commands = asyncio.to_thread(self._take_commands, asyncio.get_running_loop())
        serving = [asyncio.ensure_future(commands), asyncio.create_task(self._watch_workers())]
        await asyncio.wait(serving, return_when=asyncio.FIRST_COMPLETED)
        for part in serving:
            part.cancel()

    def _take_commands(self, loop: asyncio.AbstractEventLoop) -> None:
        """Let the loop carry out the grader's commands until the connection ends.

        This runs in a thread of its own, because the grader waits until a command is read before it reads messages.
        """
        with contextlib.suppress(Hangup):
            while True:
                command = msgspec.json.decode(self._grader.hear_json(), type=Command)
                loop.call_soon_threadsafe(self._obey, command)

    def _obey(self, command: Command) -> None:
        if isinstance(command, Give):
            self._start(self._give(command))
        else:
            self._drop(command.number)

    async def _watch_workers(self) -> None:
        """Report to the grader which workers join and leave. For this, read the scheduler's list after each event."""
        self._client.subscribe_topic("all", self._on_event)
        try:
            await asyncio.gather(*(self._introduce(*who) for who in await self._look()))
            _tell(self._grader, Asked())
            while True:
                with contextlib.suppress(TimeoutError):
                    await asyncio.wait_for(self._changed.wait(), _LINK_SECONDS)
                self._changed.clear()
                for who in await self._look():
                    self._start(self._introduce(*who))
        except Exception as error:
            _tell(self._grader, Broken(f"the scheduler has ended: {_first_line(error)}"))

    async def _look(self) -> list[tuple[str, str, int]]:
        """Report the workers that have left, and return the address, name and number of threads of each new worker."""
        workers = (await self._client.scheduler.identity())["workers"]
        for address in self._workers - workers.keys():
            for number, (worker, _) in list(self._given.items()):
                if worker == address:
                    self._drop(number)
            _tell(self._grader, Left(address))
        new = [
            (str(address), str(facts["name"]), int(facts["nthreads"]))
            for address, facts in workers.items()
            if address not in self._workers
        ]
        self._workers = set(workers)
        return new

    def _on_event(self, event: Any) -> None:
        if isinstance(event[1], dict) and event[1].get("action") in {"add-worker", "remove-worker"}:
            self._changed.set()

    async def _introduce(self, address: str, name: str, threads: int) -> None:
        try:
            # Dask's ``run`` needs no free thread of the worker, so even a busy worker sends its offer.
            asking = self._client.run(dask_calls.offer_as_json, threads, workers=[address])
            said = (await asyncio.wait_for(asking, _OFFER_SECONDS))[address]
        except TimeoutError:
            _tell(
                self._grader, Unfit(address, name, f"the worker has not answered within {_OFFER_SECONDS:g} s")
            )
        except Exception as error:
            _tell(self._grader, Unfit(address, name, _first_line(error)))
        else:
            _tell(
                self._grader,
                Joined(address, name, said) if isinstance(said, bytes) else Unfit(address, name, "no offer"),
            )

    async def _give(self, give: Give) -> None:
        if give.worker not in self._workers:
            _tell(self._grader, Failed(give.number, "the worker has ended"))
            return
        key = f"autograder-{self._batch}-{give.number}"
        future = self._client.submit(
            dask_calls.execute_order,
            give.order,
            key=key,
            workers=[give.worker],
            allow_other_workers=False,
            pure=False,
            retries=0,
        )
        self._given[give.number] = order = give.worker, future
        try:
            news: News = await self._answer(give.number, key, future)
        except Exception as error:
            news = Failed(give.number, _first_line(error))
        if self._given.get(give.number) is order:
            _tell(self._grader, news)
            self._drop(give.number)

    async def _answer(self, number: int, key: str, future: Any) -> News:
        await wait([future])
        if future.status == "error":
            return Failed(number, _first_line(await future.exception()))
        # The worker reported the answer's size to the scheduler, so an answer that is too large need not be fetched.
        size = (await self._client.nbytes(keys=[key], summary=False)).get(key, 0)
        if size > 2 * LARGEST_ANSWER:
            return Failed(number, f"the answer has {size} bytes", forged=True)
        try:
            data = await future
        except (TypeError, MemoryError) as error:
            # The answer is not plain bytes, or is larger than the worker reported.
            return Failed(number, _first_line(error), forged=True)
        if not isinstance(data, bytes):
            return Failed(number, "the answer does not consist of bytes", forged=True)
        return Answered(number, data)

    def _drop(self, number: int) -> None:
        if number in self._given:
            _, future = self._given.pop(number)
            future.release()

    def _start(self, doing: Any) -> None:
        task = asyncio.create_task(doing)
        self._running.add(task)
        task.add_done_callback(self._running.discard)


def _first_line(error: BaseException) -> str:
    text = f"{type(error).__name__}: {error}" if str(error) else type(error).__name__
    return text.splitlines()[0][:300]


def _tell(grader: Lines, news: News) -> None:
    with contextlib.suppress(Hangup):  # the grader has ended, so this process will end, too
        grader.say_json(msgspec.json.encode(news))


if __name__ == "__main__":
    main(sys.argv[1])
