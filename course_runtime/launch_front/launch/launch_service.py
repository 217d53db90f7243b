"""Runs a launch."""

from __future__ import annotations

import contextlib
import os
import selectors
import signal
import traceback
from typing import TYPE_CHECKING, Any

from .events import Shutdown
from .events.process import (
    ProcessExited,
    ProcessStarted,
    ProcessStderr,
    ProcessStdout,
    ShutdownProcess,
    SignalProcess,
)
from .launch_context import LaunchContext
from .timers import Timers

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from .action import LaunchDescriptionEntity
    from .events.base import Event
    from .running_process import RunningProcess

_END_SIGNALS = (signal.SIGTERM, signal.SIGQUIT)
_WATCHED = (signal.SIGINT, signal.SIGCHLD, *_END_SIGNALS)


class LaunchService:
    """Runs launch descriptions until nothing is left to do, or until a shutdown is requested."""

    def __init__(
        self, *, argv: Iterable[str] | None = None, noninteractive: bool = False, debug: bool = False
    ) -> None:
        self.context = LaunchContext(argv=list(argv or ()))
        self.context.screen.debug = debug
        self.context.timers = self._timers = Timers()
        self._noninteractive = noninteractive
        self._running: list[RunningProcess] = []
        self._code = 0
        self._interrupted = False
        self._selector = selectors.DefaultSelector()

    def include_launch_description(self, launch_description: LaunchDescriptionEntity) -> None:
        """Add a launch description to those that will be run."""
        self.context.to_visit.append(launch_description)

    def run(self, *, shutdown_when_idle: bool = True) -> int:
        """Run until everything has ended.

        Returns:
            0; or 1 if the launch itself failed or was terminated. The exit codes of processes do not count here; they
            are shown on the screen.

        Raises:
            RuntimeError: The log folder cannot be made.
        """
        screen = self.context.screen
        screen.open_log()
        screen.log("INFO", "launch", f"All log files can be found below {screen.folder}")
        screen.log(
            "INFO", "launch", f"Default logging verbosity is set to {'DEBUG' if screen.debug else 'INFO'}"
        )
        try:
            with self._signals():
                while True:
                    self._work()
                    left = self._timers.seconds_left()
                    idle = not self._running and left is None
                    if idle and (shutdown_when_idle or self.context.is_shutdown):
                        if self.context.is_shutdown:
                            return self._code
                        # Handlers of the shutdown may start further work.
                        self._shutdown("idle", due_to_sigint=False)
                        continue
                    self._wait(left)
        finally:
            self._clean_up()

    def shutdown(self) -> None:
        """End the launch."""
        self._shutdown("LaunchService.shutdown() called", due_to_sigint=False)

    # Methods for the work that can be done at once.

    def _work(self) -> None:
        """Visit entities, handle events and start processes until none is left."""
        context = self.context
        while True:
            try:
                if context.to_visit:
                    self._visit(context.to_visit.popleft())
                elif context.events:
                    self._handle(context.events.popleft())
                elif context.to_start:
                    self._start(context.to_start.popleft())
                else:
                    return
            except Exception as error:
                self._fail(error)

    def _fail(self, error: Exception) -> None:
        """Report an error in the launch itself, and end the launch."""
        message = f"Caught exception in launch (see debug for traceback): {error}"
        self.context.screen.log("DEBUG", "launch", traceback.format_exc())
        self.context.screen.log("ERROR", "launch", message)
        self._code = 1
        self._shutdown(message, due_to_sigint=False)

    def _visit(self, entity: LaunchDescriptionEntity) -> None:
        for inner in entity.visit(self.context) or ():
            self._visit(inner)

    def _handle(self, event: Event) -> None:
        if isinstance(event, Shutdown):
            self._shutdown(event.reason, due_to_sigint=event.due_to_sigint)
            return
        if isinstance(event, SignalProcess | ShutdownProcess):
            self._ask_processes(event)
            return
        self._tell_handlers(event)

    def _tell_handlers(self, event: Event) -> None:
        for handler in tuple(self.context.handlers):
            if handler.matches(event):
                self.context.event = event
                for entity in handler.handle(event, self.context):
                    self._visit(entity)
                self.context.event = None

    def _ask_processes(self, event: SignalProcess | ShutdownProcess) -> None:
        for process in self._running:
            if event.process_matcher(process.action):
                if isinstance(event, SignalProcess):
                    self._send(process, event.signal)
                else:
                    self._end(process, silently=False)

    # Processes

    def _event(self, kind: Any, process: RunningProcess, **more: Any) -> Any:
        plan = process.plan
        return kind(process.action, plan.name, plan.cmd, plan.cwd, plan.env, process.pid, **more)

    def _start(self, process: RunningProcess) -> None:
        if self.context.is_shutdown:
            return
        name, screen = process.plan.name, self.context.screen
        try:
            process.start()
        except OSError:
            screen.log(
                "ERROR", name, f"exception occurred while executing process:\n{traceback.format_exc()}"
            )
            return
        screen.log("INFO", name, f"process started with pid [{process.pid}]")
        self._running.append(process)
        for source, stream in process.streams.items():
            self._selector.register(stream, selectors.EVENT_READ, (process, source))
        process.action.process_started(process)
        self.context.emit_event_sync(self._event(ProcessStarted, process))

    def _read(self, process: RunningProcess, source: str) -> None:
        lines, goes_on = process.read(source)
        self._show(process, source, lines)
        if not goes_on:
            self._selector.unregister(process.streams[source])
            process.streams.pop(source).close()

    def _show(self, process: RunningProcess, source: str, lines: Iterable[bytes]) -> None:
        plan = process.plan
        for raw in lines:
            line = raw.decode(errors="replace")
            shown = plan.output_format.format(line=line, this=process.action)
            self.context.screen.output(plan.output, source, line, shown)
            kind = ProcessStdout if source == "stdout" else ProcessStderr
            if self.context.handlers:
                event = self._event(kind, process, text=raw + b"\n", **{f"from_{source}": True})
                self.context.emit_event_sync(event)

    def _reap(self) -> None:
        """Find the processes that have ended."""
        for process in [p for p in self._running if p.poll() is not None]:
            for source in tuple(process.streams):
                # This is the last output. A child process may keep the stream open, so do not wait for the end of the
                # stream.
                self._show(process, source, process.drain(source))
                self._selector.unregister(process.streams[source])
            for source in ("stdout", "stderr"):
                self._show(process, source, process.rest(source))
            self._running.remove(process)
            self._report_end(process, process.poll() or 0)
            # Processes that the ended process left behind must not outlive a launch that is ending.
            if self.context.is_shutdown:
                process.send(signal.SIGKILL)
            process.close()

    def _report_end(self, process: RunningProcess, code: int) -> None:
        plan = process.plan
        if code == 0:
            self.context.screen.log("INFO", plan.name, f"process has finished cleanly [pid {process.pid}]")
        else:
            command = " ".join(part for part in plan.cmd if part.strip())
            message = f"process has died [pid {process.pid}, exit code {code}, cmd '{command}']."
            self.context.screen.log("ERROR", plan.name, message)
        self.context.emit_event_sync(self._event(ProcessExited, process, returncode=code))
        process.action.process_ended(process, self.context, code)

    def _send(self, process: RunningProcess, number: signal.Signals, *, silently: bool = False) -> None:
        name = process.plan.name
        if not silently:
            self.context.screen.log("INFO", name, f"sending signal '{number.name}' to process[{name}]")
        process.send(number)

    def _end(self, process: RunningProcess, *, silently: bool) -> None:
        """Ask a process to end, with stronger signals if it does not."""
        if process.escalation:
            return
        plan = process.plan
        self._send(process, signal.SIGINT, silently=silently)
        total = plan.sigterm_timeout + plan.sigkill_timeout
        process.escalation = [
            self._timers.after(seconds, action, cancel_on_shutdown=False)
            for seconds, action in (
                (plan.sigterm_timeout, lambda: self._escalate(process, plan.sigterm_timeout, signal.SIGTERM)),
                (total, lambda: self._escalate(process, total, signal.SIGKILL)),
            )
        ]

    def _escalate(self, process: RunningProcess, seconds: float, number: signal.Signals) -> None:
        name, before = process.plan.name, "SIGINT" if number == signal.SIGTERM else "SIGTERM"
        message = (
            f"process[{name}] failed to terminate '{seconds:g}' seconds after receiving '{before}', "
            f"escalating to '{number.name}'"
        )
        self.context.screen.log("ERROR", name, message)
        self._send(process, number)

    # The end

    def _shutdown(self, reason: str, *, due_to_sigint: bool) -> None:
        if self.context.is_shutdown:
            return
        self.context.is_shutdown = True
        self._timers.cancel_for_shutdown()
        for process in self._running:
            # A terminal has told its foreground processes itself in the real launch, which then says nothing.
            self._end(process, silently=due_to_sigint and not self._noninteractive)
        try:
            self._tell_handlers(Shutdown(reason=reason, due_to_sigint=due_to_sigint))
        except Exception as error:
            self._fail(error)

    def _interrupt(self) -> None:
        again = " again, ignoring..." if self._interrupted else ""
        self._interrupted = True
        self.context.screen.log("WARNING", "launch", f"user interrupted with ctrl-c (SIGINT){again}")
        self._shutdown("ctrl-c (SIGINT)", due_to_sigint=True)

    def _terminate(self, number: signal.Signals) -> None:
        self.context.screen.log(
            "ERROR", "launch", f"user interrupted with ctrl-\\ ({number.name}), terminating..."
        )
        self._code = 1
        self._shutdown(number.name, due_to_sigint=False)

    def _clean_up(self) -> None:
        """End everything that is left, however the launch ended."""
        for process in self._running:
            process.send(signal.SIGKILL)
            process.close()
        for path in self.context.temporary_files:
            with contextlib.suppress(OSError):
                os.unlink(path)  # noqa: PTH108
        self._selector.close()
        self.context.screen.close()

    # Waiting

    @contextlib.contextmanager
    def _signals(self) -> Iterator[None]:
        """Make each signal write a byte that wakes the loop."""
        reading, writing = os.pipe()
        for end in (reading, writing):
            os.set_blocking(end, False)
        self._selector.register(reading, selectors.EVENT_READ)
        before = {number: signal.signal(number, lambda *_: None) for number in _WATCHED}
        wakeup = signal.set_wakeup_fd(writing)
        try:
            yield
        finally:
            signal.set_wakeup_fd(wakeup)
            for number, handler in before.items():
                signal.signal(number, handler)
            self._selector.unregister(reading)
            os.close(reading)
            os.close(writing)

    def _wait(self, seconds: float | None) -> None:
        """Wait for output, a signal, the end of a process or the next timer, and handle it."""
        for key, _ in self._selector.select(seconds):
            if key.data is not None:
                process, source = key.data
                if source in process.streams:
                    self._read(process, source)
                continue
            with contextlib.suppress(BlockingIOError):
                for byte in os.read(int(key.fd), 256):
                    self._on_signal(signal.Signals(byte))
        try:
            self._timers.fire_due()
        except Exception as error:
            self._fail(error)

    def _on_signal(self, number: signal.Signals) -> None:
        if number == signal.SIGCHLD:
            self._reap()
        elif number == signal.SIGINT:
            self._interrupt()
        elif number in _END_SIGNALS:
            self._terminate(number)
