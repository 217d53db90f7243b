"""The action that starts a process."""

from __future__ import annotations

import os
import re  # noqa: TID251  (not what a student handed in)
import shlex
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any

from ..action import LaunchDescriptionEntity, ProcessAction, as_entities
from ..event_handlers import OnProcessExit
from ..running_process import Plan, RunningProcess
from ..screen import output_plan
from ..substitution import SomeSubstitutionsType, describe, normalize, perform
from ..typed import flag, number
from ..unsupported import refuse_arguments

if TYPE_CHECKING:
    from ..launch_context import LaunchContext

_SECONDS = "5"  # seconds from SIGINT to SIGTERM, and from SIGTERM to SIGKILL
_ELSEWHERE = ("cached_output", "process_description")

Variables = Mapping[SomeSubstitutionsType, SomeSubstitutionsType]


class _Described:
    """The facts about a process that `output_format` can use, such as `this.process_description.final_name`."""

    final_name = ""
    final_cmd: list[str] = []  # noqa: RUF012 (replaced, never changed)


class ExecuteProcess(ProcessAction):
    """Starts a program."""

    def __init__(
        self,
        *,
        cmd: Iterable[SomeSubstitutionsType],
        prefix: SomeSubstitutionsType | None = None,
        name: SomeSubstitutionsType | None = None,
        cwd: SomeSubstitutionsType | None = None,
        env: Variables | None = None,
        additional_env: Variables | None = None,
        shell: bool = False,
        sigterm_timeout: SomeSubstitutionsType | None = None,
        sigkill_timeout: SomeSubstitutionsType | None = None,
        emulate_tty: bool = False,
        output: SomeSubstitutionsType | Mapping[str, Any] = "log",
        output_format: str = "[{this.process_description.final_name}] {line}",
        log_cmd: bool = False,
        on_exit: Any = None,
        respawn: bool | SomeSubstitutionsType = False,
        respawn_delay: float | None = None,
        respawn_max_retries: int = -1,
        condition: Any = None,
        **unknown: Any,
    ) -> None:
        refuse_arguments(type(self).__name__, unknown, _ELSEWHERE)
        super().__init__(condition=condition)
        self.cmd = [normalize(part) for part in cmd]
        self.process_description = _Described()
        self.shell, self.cwd = shell, None if cwd is None else normalize(cwd)
        self._prefix = None if prefix is None else normalize(prefix)
        self._name = None if name is None else normalize(name)
        self.env = _variables(env)
        self._additional_env = _variables(additional_env) or []
        self._timeouts = (sigterm_timeout, sigkill_timeout)
        self._emulate_tty, self._output_format, self._log_cmd = emulate_tty, output_format, log_cmd
        self._output = os.environ.get("OVERRIDE_LAUNCH_PROCESS_OUTPUT", output)
        self._on_exit = on_exit
        self._respawn, self._respawn_delay = respawn, respawn_delay
        self._retries_left = respawn_max_retries
        self._executed = False
        self._returned: int | None = None
        self._process: RunningProcess | None = None

    @property
    def name(self) -> str:
        """The name of the process, such as `talker-1`; empty if not known yet."""
        return self.process_description.final_name

    @property
    def return_code(self) -> int | None:
        """The exit code; None while the process runs."""
        return self._returned

    def describe(self) -> str:
        """Return the text of the action for `--print`."""
        cmd = ", ".join(describe(part) for part in self.cmd)
        cwd = None if self.cwd is None else f"'{describe(self.cwd)}'"
        env = None
        if self.env is not None:
            env = "{" + ", ".join(f"{describe(k)}: {describe(v)}" for k, v in self.env) + "}"
        return f"ExecuteProcess(cmd=[{cmd}], cwd={cwd}, env={env}, shell={self.shell})"

    def sub_entities(self) -> Iterable[LaunchDescriptionEntity]:
        """Return the entities that are visited when the process ends, as far as they are known."""
        return [] if self._on_exit is None or callable(self._on_exit) else as_entities(self._on_exit)

    def command(self, context: LaunchContext) -> list[str]:
        """Return the command line without a prefix. A Node adds its ROS arguments here."""
        return [perform(context, part) for part in self.cmd]

    def execute(self, context: LaunchContext) -> None:
        """Decide everything about the process. It starts when the whole description has been read.

        Raises:
            RuntimeError: This action has already been executed.
        """
        if self._executed:
            raise RuntimeError(f"ExecuteProcess action '{self.name}': executed more than once")
        self._executed = True
        if context.is_shutdown:
            return
        plan = self._plan(context)
        self.process_description.final_name = plan.name
        self.process_description.final_cmd = list(plan.cmd)
        # A wrong format is reported here, and not at the first line of output.
        plan.output_format.format(line="", this=self)
        if self._log_cmd:
            context.screen.log(
                "INFO",
                plan.name,
                f"process details: cmd='{' '.join(plan.cmd)}', cwd='{plan.cwd}', custom_env?=True",
            )
        self._respawn = flag(context, self._respawn)
        context.to_start.append(RunningProcess(self, plan))

    def _plan(self, context: LaunchContext) -> Plan:
        cmd = self._prefixed(context, self.command(context))
        context.process_count += 1
        label = os.path.basename(cmd[0]) if self._name is None else perform(context, self._name)  # noqa: PTH119
        name = f"{label}-{context.process_count}"
        env = dict(context.environment) if self.env is None else {}
        for variable, value in [*(self.env or []), *self._additional_env]:
            env[perform(context, variable)] = perform(context, value)
        output = (
            self._output if isinstance(self._output, Mapping) else perform(context, normalize(self._output))
        )
        configured = context.launch_configurations
        term, kill = (
            number(context, configured.get(setting, _SECONDS) if given is None else given)
            for setting, given in zip(("sigterm_timeout", "sigkill_timeout"), self._timeouts, strict=True)
        )
        return Plan(
            name=name,
            cmd=cmd,
            shell=self.shell,
            cwd=None if self.cwd is None else perform(context, self.cwd),
            env=env,
            output=output_plan(name, output),
            output_format=self._output_format,
            emulate_tty=flag(context, configured.get("emulate_tty", self._emulate_tty)),
            sigterm_timeout=term,
            sigkill_timeout=kill,
        )

    def _prefixed(self, context: LaunchContext, cmd: list[str]) -> list[str]:
        configured = context.launch_configurations
        if self._prefix is not None:
            return [*shlex.split(perform(context, self._prefix)), *cmd]
        wanted = re.match(configured.get("launch-prefix-filter", ""), os.path.basename(cmd[0]))  # noqa: PTH119
        return [*shlex.split(configured.get("launch-prefix", "")), *cmd] if wanted else cmd

    def process_started(self, process: RunningProcess) -> None:
        """Record the running process."""
        self._process, self._returned = process, None

    def process_ended(self, process: RunningProcess, context: LaunchContext, code: int) -> None:
        """Run what was requested for the end of the process. Start the process again if that was requested."""
        self._returned = code
        if self._on_exit is not None:
            # This handler comes before other handlers, and applies once to each run of the process.
            handler = OnProcessExit(target_action=self, on_exit=self._on_exit, handle_once=True)
            context.register_event_handler(handler)
        if not self._respawn or context.is_shutdown or self._retries_left == 0 or context.timers is None:
            return
        self._retries_left -= 1
        again = RunningProcess(self, process.plan)
        context.timers.after(self._respawn_delay or 0.0, lambda: context.to_start.append(again))


def _variables(given: Variables | None) -> list[tuple[Any, Any]] | None:
    return None if given is None else [(normalize(name), normalize(value)) for name, value in given.items()]
