"""A role brings its mistakes: an author's own scenario and the oracle recognize what the recipe of the role does."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import pytest

from autograder.kit.draft import Draft
from autograder.kit.evidence import Event, Evidence, Part, Reference
from autograder.kit.mission.mission import Mission
from autograder.kit.mistakes.common_mistakes import endpoint_name
from autograder.kit.oracle.action_server import SendsGoals
from autograder.kit.oracle.goals_seen import GoalsSeen
from autograder.kit.oracle.same_as_solution import SameAsSolution
from autograder.kit.output.launched_processes import Process, process_line
from autograder.kit.output.workspace_reports import WorkspaceReport, workspace_report_line
from autograder.kit.recipes.action_client import ActionClient
from autograder.kit.recipes.own_scenario import OwnScenario
from autograder.kit.recipes.program import Program
from autograder.kit.recipes.publisher import Publisher
from autograder.kit.recipes.servers import Asks
from autograder.kit.recipes.service_client import Calls
from autograder.kit.recipes.subscriber import Subscriber
from autograder.kit.runners import LaunchesFromPackage, RunsProgram
from tests.cases import named_cases

if TYPE_CHECKING:
    from collections.abc import Sequence

    from autograder.kit.draft import Recipe
    from autograder.kit.model import Mistake

RECIPES: dict[str, tuple[Recipe[Any], str]] = {
    "publisher": (
        Publisher(),
        # What only the rate and the end of an endless series of messages show.
        "published_before_discovery wrong_rate stopped_publishing",
    ),
    "subscription": (
        Subscriber(pace=0.5, paced_by="a timer"),
        # What only texts that have to be repeated show.
        "not_logged wrong_text invented_text callback_too_slow everything_twice",
    ),
    "service": (Asks(lambda _: [], lambda _: {}), ""),
    "client": (
        Calls(1, wanted=""),
        # What only a service that comes late or never, and a client that ends by itself, show.
        "not_forgotten usage_message waits_forever silent_end patience_not_kept gave_up_too_early "
        # What only a sum shows.
        "too_many_calls wrong_arguments no_call wrong_sum_reported sum_not_reported zero_taken_for_failure "
        "not_returned result_read_too_early",
    ),
    "action_server": (
        SendsGoals(lambda _: None, lambda seen: GoalsSeen(seen, [], [], [], [], [], [], [], None)),
        # What only goals of which the judge knows the right end show.
        "older_goal_ended goals_mixed_up goal_rejected done_at_once",
    ),
    "action_client": (ActionClient(lambda _: None), "not_forgotten"),
}
"""For each role, its recipe, and the keys of the mistakes that only the scenario of this recipe can show."""


def keys(mistakes: Sequence[Mistake]) -> set[str]:
    return {known.key for known in mistakes} - {""}


def declared(*roles: str) -> dict[str, Sequence[Mistake]]:
    """The mistakes of an author's own scenario, of the oracle and of a mission with these roles."""
    own = Draft("a.b", "A", "B", OwnScenario(lambda _: None, *roles)).exercise()
    oracle = SameAsSolution("a.b", "A", "B", gives=lambda _: [], tells={"/a": "data"}, roles=roles).exercise()
    mission = Mission("a.b", "A", "B", roles=roles).exercise()
    return {"own scenario": own.mistakes, "oracle": oracle.mistakes, "mission": mission.mistakes}


@pytest.mark.parametrize("role", RECIPES)
def test_an_exercise_without_a_recipe_loses_no_mistake_of_the_role(role: str) -> None:
    recipe, only_there = RECIPES[role]
    for kind, mistakes in declared(role).items():
        assert keys(recipe.ladder) - keys(mistakes) - set(only_there.split()) == set(), kind


@pytest.mark.parametrize("role", RECIPES)
def test_a_mistake_of_one_role_alone_is_not_looked_for_in_another(role: str) -> None:
    (of_servers, of_goals) = {"two_servers"}, {"result_missing", "cancel_not_accepted"}
    found = keys(declared(role)["own scenario"])
    assert (of_servers <= found) is (role in ("service", "action_server"))
    assert (of_goals <= found) is (role == "action_server")
    assert ("called_too_early" in found) is ("client" in role)


# --- each is recognized, and only if it was made ------------------------------------------------------------------

NAMES = {
    "publisher": {"/a": "std_msgs/msg/String"},
    "service": {"/serve": "std_srvs/srv/Empty"},
    "action_server": {"/dock": "x/action/Dock"},
}


def first(role: str, *events: Event, recorded: Sequence[Event] = ()) -> str:
    """The key of the first mistake of an own scenario that these events of a spun node show."""
    interface = {role: NAMES[role]}
    graph = Event(0.1, "interface", "graph", {"nodes": ["/one"], **interface})
    reference = Reference("a.b", interface, [Part("met", {}, recorded)])
    evidence = Evidence([Part("met", {}, [graph, *events])], reference)
    mistakes = declared(role)["own scenario"]
    return next((known.key for known in mistakes if known.recognize(evidence)), "")


def message(text: str, number: int) -> Event:
    return Event(1.0, "message", "/a", {"fields": {"data": text}, "number": number})


MESSAGES = [message(f"{n}", n) for n in range(8)]


@pytest.mark.parametrize(
    ("messages", "recorded", "key"),
    [
        (MESSAGES, MESSAGES, ""),
        ([], MESSAGES, "never_published"),
        ([], [], ""),
        ([], [Event(1.0, "noted", "/a", {"values": [["on"]]})], "never_published"),
        ([], [Event(1.0, "noted", "/a", {"values": []})], ""),
    ],
    ids=[
        "as the solution does",
        "silent",
        "as silent as the solution",
        "silent, where the solution's outputs are noted",
        "as silent as the solution's outputs",
    ],
)
def test_a_publisher_that_says_nothing(
    messages: Sequence[Event], recorded: Sequence[Event], key: str
) -> None:
    assert first("publisher", *messages, recorded=recorded) == key


@pytest.mark.parametrize(
    ("is_launched", "text", "begins"),
    [
        (False, "Your node publishes on /b, but the task asks for the topic /a.", "Compare the names"),
        (
            True,
            "No program of yours publishes on /a, as the task asks; one publishes on /b.",
            "Does your launch file",
        ),
    ],
)
def test_of_a_launch_a_missing_name_may_be_that_of_a_program_that_was_not_started(
    *, is_launched: bool, text: str, begins: str
) -> None:
    reference = Reference("a.b", {"publisher": NAMES["publisher"]}, [Part("met", {}, [])])
    graph = Event(0.1, "interface", "graph", {"nodes": ["/one"], "publisher": {"/b": "std_msgs/msg/String"}})
    started = Event(0.0, "output", "terminal", {"text": process_line(Process(2, 1, ("python3", "b.py")))})
    part = Part("met", {}, [graph, *[started] * is_launched])
    advice = endpoint_name("publisher").recognize(Evidence([part], reference))
    assert advice is not None
    assert advice.text == text
    assert advice.next_step.startswith(begins)


@pytest.mark.parametrize("role", ["service", "action_server"])
def test_two_servers_of_one_name(role: str) -> None:
    (name,) = NAMES[role]
    assert first(role, Event(0.2, "servers", name, {"count": 1})) == ""
    assert first(role, Event(0.2, "servers", name, {"count": 2})) == "two_servers"


@pytest.mark.parametrize(
    ("accepted", "code", "key"), [(True, 0, ""), (False, 1, "cancel_not_accepted"), (False, 3, "")]
)
def test_a_server_that_refuses_to_cancel_a_goal_that_is_not_over(accepted: bool, code: int, key: str) -> None:
    def event(kind: str, **data: Any) -> Event:
        return Event(1.0, kind, "/dock", {"goal": 0, **data})

    answered = event("cancel_answer", accepted=accepted, return_code=code)
    assert first("action_server", event("goal_sent", fields={}), event("cancel_sent"), answered) == key


@pytest.mark.parametrize("role", NAMES)
def test_a_second_node_of_the_same_name_that_nothing_spins(role: str) -> None:
    twin = "[rcl.logging_rosout]: Publisher already registered for node name: 'one'. If this is due to ..."
    printed = Event(0.2, "output", "stderr", {"text": twin})
    assert first(role, printed) == "never_spun"
    assert first("publisher", printed, message("hello", 1)) == ""


# --- runners -------------------------------------------------------------------------------------------------------


def test_a_runner_of_a_program_brings_what_its_recipe_has() -> None:
    recipe = Program("fleet_pkg", "cruise", "cruising")
    whole = Draft("a.b", "A", "B", recipe).exercise(runner=recipe.runner)
    own = Draft("a.b", "A", "B", OwnScenario(lambda _: None, "publisher")).exercise(runner=recipe.runner)
    assert {"package_name", "entry_point", "wrong_folder"} <= keys(whole.mistakes)
    assert keys(whole.mistakes) <= keys(own.mistakes)


@pytest.mark.parametrize(
    ("runner", "missing", "key"),
    [
        (RunsProgram("fleet_pkg", "cruise"), "cruise", "entry_point"),
        (RunsProgram("fleet_pkg", "cruise"), "fleet_pkg", "package_name"),
        (LaunchesFromPackage("fleet_pkg", "all.launch"), "fleet_pkg", "package_name"),
    ],
)
def test_what_a_workspace_lacks_is_named_in_an_own_scenario(runner: Any, missing: str, key: str) -> None:
    report = workspace_report_line(WorkspaceReport("built", built=True, missing=missing))
    events = [Event(0.1, "output", "stdout", {"text": report}), Event(0.2, "subject", "exited", {"code": 1})]
    evidence = Evidence([Part("met", {}, events)], Reference("a.b", {"publisher": NAMES["publisher"]}))
    own = Draft("a.b", "A", "B", OwnScenario(lambda _: None, "publisher")).exercise(runner=runner)
    assert next(known.key for known in own.mistakes if known.recognize(evidence)) == key


def test_two_servers_never_pass_by_the_luck_of_the_right_one() -> None:
    oracle = SameAsSolution("a.b", "A", "B", gives=lambda _: [], tells={"/serve": "ok"}, roles=("service",))
    noted = Event(0.3, "noted", "/serve", {"step": 0, "given": "", "values": [[True]]})
    reference = Reference("a.b", {"service": NAMES["service"]}, [Part("drawing 0", {}, [noted])])
    (criterion,) = oracle.exercise().criteria
    for count in (1, 2):
        seen = Part("drawing 0", {}, [Event(0.2, "servers", "/serve", {"count": count}), noted])
        finding = criterion.judge(Evidence([seen], reference))
        assert finding.passed is (count == 1)
        assert finding.passed or finding.seen == "2 servers of /serve"


@pytest.mark.parametrize(
    ("value", "words"), named_cases(__file__, "a_whole_number_in_a_field_for_floats_is_named_as_that")
)
def test_a_whole_number_in_a_field_for_floats_is_named_as_that(value: float, words: str) -> None:
    reference = Reference("a.b", {"publisher": {"/cmd_vel": "geometry_msgs/msg/Twist"}})
    fields = {"linear": {"x": value, "y": 0.0}, "angular": {"z": 0.0}}
    evidence = Evidence(
        [Part("mission", {}, [Event(0.0, "message", "/cmd_vel", {"fields": fields})])], reference
    )
    for kind, mistakes in declared("publisher").items():
        told = [one.recognize(evidence) for one in mistakes if one.key == "field_type"]
        assert [words in one.text for one in told if one] == [True] * bool(words), kind
