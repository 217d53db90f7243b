"""A bench on paper: runs an exercise's scenario on a program in this process, in milliseconds.

The scenario and the criteria are the exercise's own. Of the bench it has what a recipe needs that compares a node or a
function with the solution; anything else raises :class:`autograder.authoring.paper.network.UnknownOnPaper`.
"""

from __future__ import annotations

import inspect
import json
import sys
import traceback
import types
from functools import partial
from typing import TYPE_CHECKING, Any

from autograder.authoring.paper.actions import PaperAction
from autograder.authoring.paper.network import EPOCH, SECOND, Hangs, Network, UnknownOnPaper, matches
from autograder.judge.bench.qos_profiles import profile, qos_of
from autograder.judge.bench.ros_interfaces import filled, interface, to_data
from autograder.judge.bench.subject_time import FIRST
from autograder.kit.bench import STEP, Pace
from autograder.kit.counterparts import Qos
from autograder.kit.evidence import Event, Evidence, Part

if TYPE_CHECKING:
    from collections.abc import Callable, Container, Mapping
    from random import Random

    from autograder.authoring.paper.endpoints import Publisher, Service
    from autograder.kit.counterparts import Work
    from autograder.kit.evidence import Reference

_OF_PARAMETERS = "parameter"
"""In the names of the services that every node has."""


class PaperBench:
    """Runs the parts of a scenario on a program. It implements :class:`autograder.kit.bench.Bench`.

    Args:
        code: The compiled program.
        root: The name of the class or function that is judged.
        reference: The record of the solution; without parts while the solution itself is recorded.
        random: Draws the inputs.

    Attributes:
        parts: The record of each part that has ended.
    """

    pace = Pace.FAST
    before = None
    in_a_cell = is_waited_for = False

    def __init__(self, code: types.CodeType, root: str, reference: Reference, random: Random) -> None:
        self.reference, self.random = reference, random
        self.parts: list[Part] = []
        self._code, self._root = code, root
        self._made: dict[str, Any] | None = None
        self._name, self._inputs = "", dict[str, Any]()
        self._listens: dict[str, tuple[Any, Qos]] = {}
        self.events: list[Event] = []
        self.ended = False
        self._network = Network(self._hear, self._log)

    def __getattr__(self, name: str) -> Any:
        raise UnknownOnPaper(f"bench.{name}")

    def part(self, name: str, **inputs: Any) -> None:
        self._name, self._inputs = name, inputs
        self.events, self.ended = [], False
        self._listens = {}
        self._network = Network(self._hear, self._log)

    def again(self, name: str = "") -> None:
        if name:
            raise UnknownOnPaper("bench.again(name)")
        self.part(self._name, **self._inputs)

    def stop(self) -> None:
        self.parts.append(self.seen())

    def seen(self) -> Part:
        return Part(self._name, self._inputs, tuple(self.events))

    def heard(self, topic: str) -> int:
        return sum(event.kind == "message" and event.name == topic for event in self.events)

    def note(self, name: str, **data: Any) -> None:
        self.record("noted", name, **data)

    def record(self, kind: str, name: str, **data: Any) -> None:
        """Record an event."""
        simulated = self._network.simulated
        wall = (self._network.wall - EPOCH) / SECOND
        self.events.append(Event(wall, kind, name, data, None if simulated is None else simulated / SECOND))

    def start(self, *arguments: Any, **_: Any) -> None:
        def run() -> None:
            if self._made is None:
                module = types.ModuleType("answer")
                sys.modules[module.__name__] = module  # a dataclass looks there
                exec(self._code, module.__dict__)
                self._made = module.__dict__
            root = self._made[self._root]
            if inspect.isclass(root):
                root()
                return
            value = root(*json.loads(json.dumps(arguments)))
            self.record("subject", "returned", value=repr(value))
            self.ended = True

        self._guarded(run)

    def _guarded(self, run: Callable[[], object]) -> bool:
        """Run the program's code. Return False if it has ended, now or before."""
        if self.ended:
            return False
        try:
            run()
        except UnknownOnPaper:
            raise
        except Hangs:
            self.record("unanswered", self._root)
            self.ended = True
        except BaseException:
            self.record("subject", "raised", traceback=traceback.format_exc())
            self.ended = True
        return not self.ended

    def _nothing(self) -> None:
        """Do nothing: on paper, no message is on its way, and no thread hangs."""

    release = await_attention = take_in = doubt = note_whether_it_spins = note_where_it_hangs = _nothing

    def settle(self) -> None:
        self._guarded(self._network.spin)

    @property
    def moment(self) -> float:
        """The subject's time now, in seconds."""
        return (self._network.time - (EPOCH if self._network.simulated is None else 0)) / SECOND

    def await_end(self, within: float) -> bool:
        del within
        return self.ended

    def _endpoints(self) -> dict[str, dict[str, str]]:
        ends = {role: self._of_nodes(role) for role in ("publisher", "subscription", "service", "client")}
        ends["service"] = [e for e in ends["service"] if _OF_PARAMETERS not in e.name.rpartition("/")[2]]
        ends["action_client"] = self._network.action_clients
        return {role: {end.name: _type(end.kind) for end in some} for role, some in ends.items()}

    def _of_nodes(self, role: str) -> list[Any]:
        """Return the endpoints that all nodes have in a role such as ``publisher``."""
        return [end for node in self._network.nodes for end in getattr(node, f"{role}s")]

    def await_endpoint(self, role: str, name: str) -> bool:
        return not self.ended and name in self._endpoints().get(role, {})

    def watch_graph(self, condition: Callable[[Evidence], bool], within: float) -> bool:
        del within
        unusual = [
            (role, end.name, str(qos))
            for role in ("publisher", "subscription")
            for end in self._of_nodes(role)
            if (qos := _qos(end.profile)) is not Qos.DEFAULT
        ]
        nodes = [node.full_name for node in self._network.nodes]
        self.record("interface", "graph", nodes=nodes, qos=unusual, **self._endpoints())
        return condition(self._evidence())

    def _evidence(self) -> Evidence:
        return Evidence([self.seen()], self.reference)

    def listen(self, topic: str, type_name: str, *, qos: Qos = Qos.DEFAULT) -> None:
        self._listens[topic] = interface(type_name), qos
        for publisher in self._of_nodes("publisher"):
            is_late = publisher.name == topic and qos is Qos.LATCHED
            if is_late and matches(publisher.profile, profile(qos)):
                first = max(0, len(publisher.sent) - max(1, publisher.profile.depth))
                for number, message in enumerate(publisher.sent[first:], first + 1):
                    self._hear(publisher, message, number)

    def _hear(self, publisher: Publisher, message: Any, number: int) -> None:
        kind, qos = self._listens.get(publisher.name, (None, Qos.DEFAULT))
        if kind is not publisher.kind:
            return
        if matches(publisher.profile, profile(qos)):
            self.record("message", publisher.name, fields=to_data(message), number=number)
        else:
            self.record("mismatch", publisher.name, policy="")

    def _log(self, logger: str, level: int, text: str) -> None:
        self.record("log", logger, text=text, level=level)

    def speak(self, topic: str, type_name: str, *, qos: Qos = Qos.DEFAULT) -> _Speaker:
        return _Speaker(self, self._network, topic, type_name, qos)

    def serve(
        self,
        service: str,
        type_name: str,
        answer: Callable[[Mapping[str, Any]], Mapping[str, Any]],
        *,
        hold: int = 0,
        late: Mapping[int, float] = types.MappingProxyType({}),
        never: Container[int] = (),
    ) -> None:
        if hold:
            raise UnknownOnPaper("bench.serve(hold=…)")
        kind, network, count = interface(type_name), self._network, 0

        def take(request: Any, send: Callable[[Any], None]) -> None:
            nonlocal count
            count += 1
            fields = to_data(request)
            self.record("request", service, fields=fields)
            response = filled(kind.Response, dict(answer(fields)), service)

            def respond() -> None:
                self.record("response", service, fields=to_data(response))
                send(response)

            if count in late:
                network.later(round(late[count] * SECOND), respond)
            elif count not in never:
                respond()

        network.served[service] = take

    def serve_goals(self, action: str, type_name: str, work: Callable[[Mapping[str, Any]], Work]) -> None:
        self._network.actions[action] = PaperAction(self, action, type_name, work).take

    def call(self, service: str, type_name: str) -> _Caller:
        return _Caller(self, service, type_name)

    def services(self, name: str) -> list[Service]:
        """Return the subject's services of a name."""
        return [end for end in self._of_nodes("service") if end.name == name]

    def ask(self, service: Service, request: Any, answered: Callable[[Any], None]) -> None:
        """Send a request to a service of the subject."""
        self._guarded(lambda: service.answer(request, answered))

    def run_time(
        self,
        seconds: float,
        *,
        until: Callable[[], bool] | None = None,
        quiet: float | None = None,
        step: float = STEP,
    ) -> bool:
        del quiet
        network = self._network
        if network.simulated is None:
            network.begin_simulated_time(round(FIRST * SECOND))
            if not self._guarded(network.spin):
                return False
        assert network.simulated is not None
        began, end, length = (
            network.simulated,
            network.simulated + round(seconds * SECOND),
            round(step * SECOND),
        )
        while network.simulated < end and not (until is not None and until()):
            network.send_due()
            if not self._guarded(network.spin):
                return False
            # The steps until something is due are made at once.
            due = min(network.next_due, end) - began
            steps = max(-(-due // length), (network.simulated - began) // length + 1)
            network.simulated = min(end, began + steps * length)
            if not self._guarded(network.spin):
                return False
        network.send_due()
        return self._guarded(network.spin)

    def wait_until(
        self, condition: Callable[[Evidence], bool], within: float, *, quiet: float | None = None
    ) -> bool:
        del quiet
        self._guarded(self._network.spin)
        if condition(self._evidence()):
            return True
        self._network.wall += round(within * SECOND)
        self._guarded(self._network.spin)
        return condition(self._evidence())

    def deliver(self, topic: str, qos: Qos, message: Any) -> None:
        """Send a message to the subject."""
        self._network.deliver(topic, profile(qos), message)


class _Speaker:
    def __init__(self, bench: PaperBench, network: Network, topic: str, type_name: str, qos: Qos) -> None:
        self._bench, self._network, self._topic, self._qos = bench, network, topic, qos
        self._type = interface(type_name)

    def send(self, **fields: Any) -> None:
        self._bench.record("sent", self._topic, fields=dict(fields))
        self._network.deliver(self._topic, profile(self._qos), filled(self._type, fields, self._topic))


class _Caller:
    def __init__(self, bench: PaperBench, service: str, type_name: str) -> None:
        self._bench, self._service, self._type = bench, service, interface(type_name)
        self._asked = self._answered = 0

    def await_server(self, within: float) -> bool:
        del within
        count = len(self._bench.services(self._service))
        self._bench.record("servers", self._service, count=count)
        return count > 0

    def ask(self, *requests: Mapping[str, Any]) -> None:
        for fields in requests:
            number, self._asked = self._asked, self._asked + 1
            self._bench.record("asked", self._service, call=number, fields=dict(fields))
            for server in self._bench.services(self._service)[:1]:
                request = filled(self._type.Request, fields, self._service)
                self._bench.ask(server, request, partial(self._take, number))

    def _take(self, number: int, response: Any) -> None:
        self._answered += 1
        self._bench.record("answered", self._service, call=number, fields=to_data(response))

    def await_answers(self, quiet: float) -> bool:
        del quiet
        self._bench.settle()
        return self._answered >= self._asked


def _type(kind: Any) -> str:
    package, _, rest = kind.__module__.partition(".")
    return f"{package}/{rest.split('.')[0]}/{kind.__name__}"


def _qos(made: Any) -> Qos:
    return qos_of({"reliability": made.reliability, "durability": made.durability})
