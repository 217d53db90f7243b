"""Start a ROS node."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from launch.actions.process import ExecuteProcess
from launch.substitution import SomeSubstitutionsType, normalize, perform

from ..names import check_namespace, check_node_name, inner_namespace
from ..parameter_descriptions import Parameter, ParameterFile, evaluate_dictionary, write_temporary
from ..substitutions import ExecutableInPackage
from .scope import NAMESPACE

if TYPE_CHECKING:
    from launch.launch_context import LaunchContext

Remapping = tuple[SomeSubstitutionsType, SomeSubstitutionsType]


class Node(ExecuteProcess):
    """A node: a program of a package, with its name, namespace, remappings and parameters."""

    def __init__(
        self,
        *,
        executable: SomeSubstitutionsType,
        package: SomeSubstitutionsType | None = None,
        name: SomeSubstitutionsType | None = None,
        namespace: SomeSubstitutionsType | None = None,
        exec_name: SomeSubstitutionsType | None = None,
        parameters: Sequence[Any] | None = None,
        remappings: Iterable[Remapping] | None = None,
        ros_arguments: Iterable[SomeSubstitutionsType] | None = None,
        arguments: Iterable[SomeSubstitutionsType] | None = None,
        **kwargs: Any,
    ) -> None:
        if "cmd" in kwargs:
            raise TypeError("Node() got an unexpected keyword argument 'cmd'")
        program = executable if package is None else ExecutableInPackage(executable, package)
        cmd = [program, *(arguments or ())]
        if ros_arguments is not None:
            cmd += ["--ros-args", *ros_arguments]
        super().__init__(cmd=[*cmd, "--ros-args"], name=exec_name, **kwargs)
        self._node_name = None if name is None else normalize(name)
        self._namespace = None if namespace is None else normalize(namespace)
        self._parameters = _checked_parameters(parameters)
        self._remappings = [_checked_remapping(rule) for rule in remappings or ()]

    def command(self, context: LaunchContext) -> list[str]:
        """Return the command line with all ROS arguments.

        Raises:
            ValueError: The name or the namespace is not valid.
            SubstitutionFailure: The package or the program does not exist.
        """
        ros: list[str] = []
        name = None if self._node_name is None else perform(context, self._node_name)
        if name is not None:
            check_node_name(name)
            ros += ["-r", f"__node:={name}"]
        given = None if self._namespace is None else perform(context, self._namespace)
        namespace = inner_namespace(context.launch_configurations.get(NAMESPACE), given or None)
        if namespace is not None:
            check_namespace(namespace)
            ros += ["-r", f"__ns:={namespace}"]
        for parameter, value in context.parameters:
            ros += ["-p", f"{parameter}:={_flow_yaml(value)}"]
        ros += self._parameter_arguments(context, name, namespace)
        own = [(perform(context, src), perform(context, dst)) for src, dst in self._remappings]
        for src, dst in [*context.remappings, *own]:
            ros += ["-r", f"{src}:={dst}"]
        return [*super().command(context), *ros]

    def _parameter_arguments(
        self, context: LaunchContext, name: str | None, namespace: str | None
    ) -> list[str]:
        arguments: list[str] = []
        # Without a name and a namespace the full name of the node is unknown. So the parameters are for any node that
        # the program makes.
        full = f"{namespace.rstrip('/')}/{name}" if name and namespace else "/**"
        for given in self._parameters:
            if isinstance(given, Mapping):
                import yaml

                values = {full: {"ros__parameters": evaluate_dictionary(context, given)}}
                path = write_temporary(context, yaml.dump(values, default_flow_style=False))
                arguments += ["--params-file", path]
            elif isinstance(given, Parameter):
                parameter, value = given.evaluate(context)
                arguments += ["-p", f"{parameter}:={_flow_yaml(value)}"]
            else:
                path = given.evaluate(context)
                if os.path.isfile(path):  # noqa: PTH113
                    arguments += ["--params-file", path]
                else:
                    context.screen.log(
                        "WARNING", "launch_ros.actions.node", f"Parameter file path is not a file: {path}"
                    )
        return arguments

    def execute(self, context: LaunchContext) -> None:
        """Start the node. Warn if another node already has its full name."""
        super().execute(context)
        words = self.process_description.final_cmd
        named = {word.partition(":=")[0]: word.partition(":=")[2] for word in words if word.startswith("__")}
        if "__node" not in named or "__ns" not in named:
            return
        full = f"{named['__ns'].rstrip('/')}/{named['__node']}"
        context.node_names[full] = context.node_names.get(full, 0) + 1
        if context.node_names[full] > 1:
            context.screen.log(
                "WARNING",
                self.name,
                f"there are now at least {context.node_names[full]} nodes with the name {full} created "
                "within this launch context",
            )


def _flow_yaml(value: Any) -> str:
    """Return a value as one line of YAML."""
    import yaml

    return str(yaml.dump(value, default_flow_style=True)).removesuffix("\n").removesuffix("\n...")


def _checked_parameters(given: Sequence[Any] | None) -> list[Mapping[Any, Any] | Parameter | ParameterFile]:
    if isinstance(given, str | Mapping) or not isinstance(given, Sequence | None):
        raise TypeError(
            f"Node(parameters=…) must be a list of dictionaries and files, as parameters=[{{'rate': 2.0}}], "
            f"got {given!r}"
        )
    return [
        item if isinstance(item, Mapping | Parameter | ParameterFile) else ParameterFile(item)
        for item in given or ()
    ]


def _checked_remapping(rule: Any) -> tuple[Any, Any]:
    if not isinstance(rule, tuple) or len(rule) != 2:
        raise TypeError(
            f"Node(remappings=…) must be a list of pairs, as remappings=[('chatter', 'news')], got {rule!r}"
        )
    return normalize(rule[0]), normalize(rule[1])
