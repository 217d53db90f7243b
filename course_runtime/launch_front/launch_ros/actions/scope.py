"""Settings for all nodes that follow in the same group."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from launch.action import Action
from launch.substitution import SomeSubstitutionsType, normalize, perform

from ..names import check_namespace, inner_namespace
from ..parameter_descriptions import evaluate_dictionary

if TYPE_CHECKING:
    from launch.launch_context import LaunchContext

# The variable that contains the namespace of the current scope, as in the real launch. Included files can read it.
NAMESPACE = "ros_namespace"


class PushROSNamespace(Action):
    """Puts the following nodes into a namespace."""

    def __init__(self, namespace: SomeSubstitutionsType, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        self._namespace = normalize(namespace)

    def execute(self, context: LaunchContext) -> None:
        """Set the namespace, inside the current namespace.

        Raises:
            ValueError: The text is not a namespace.
        """
        outer = context.launch_configurations.get(NAMESPACE)
        namespace = inner_namespace(outer, perform(context, self._namespace)) or "/"
        check_namespace(namespace)
        context.launch_configurations[NAMESPACE] = namespace


class SetRemap(Action):
    """Remaps a name in the following nodes."""

    def __init__(self, src: SomeSubstitutionsType, dst: SomeSubstitutionsType, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        self._src, self._dst = normalize(src), normalize(dst)

    def execute(self, context: LaunchContext) -> None:
        """Add the rule."""
        context.remappings = [
            *context.remappings,
            (perform(context, self._src), perform(context, self._dst)),
        ]


class SetParameter(Action):
    """Sets a parameter in the following nodes."""

    def __init__(self, name: SomeSubstitutionsType, value: Any, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        self._name, self._value = normalize(name), value

    def execute(self, context: LaunchContext) -> None:
        """Add the parameter."""
        found = evaluate_dictionary(context, {tuple(self._name): self._value})
        context.parameters = [*context.parameters, *found.items()]
