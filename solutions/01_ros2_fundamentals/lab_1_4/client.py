"""Lab 1.4: an action client that sends a goal, shows feedback and tells how the goal ended."""

from __future__ import annotations

from autograder.kit import Draft, giving_up, goal_reports
from autograder.kit.recipes.one_goal import sends_goals

client = Draft(
    "lab_1_4.client",
    "Lab 1.4 · A client that sends a goal",
    "Send a goal to the action fibonacci, show its feedback, report its result and how it ended.",
    sends_goals(),
)
client.asks("goal", "Sends one goal of the given order", goal_reports.sends_the_goal, points=2)
client.asks("feedback", "Shows each feedback message", goal_reports.shows_feedback, points=2)
client.asks(
    "result", "Reports the result", goal_reports.reports_the_result, uses=("get_result_async",), points=2
)
client.asks(
    "refused", "Says when the goal is rejected", goal_reports.returns_nothing_of_a_refused_goal, points=1
)
client.asks("aborted", "Says when the goal is aborted", goal_reports.tells_of_abort, points=1)
client.asks("late", "Waits for a server that comes late", goal_reports.waits_for_the_server, points=1)
client.asks("limit", "Ends clearly when there is no server", goal_reports.ends_without_a_server, points=1)

EXERCISE = client.exercise(
    limit=180.0,
    arguments="the order",
    remarks=(goal_reports.may_wait_on,),
    sample_arguments=(10,),
    text={
        "Wait for the server: `client.actions.wait_for_server(timeout_sec=...)` returns `False`": "late limit",
        "In this case raise `TimeoutError`, with a message that contains `not available`.": "limit",
        "Make the goal, `Fibonacci.Goal(order=...)`, and send it": "goal feedback",
        "Wait for the future that you get, and return its result": "goal",
        "so wait until the future is done.": "goal",
        "Your function must say how the goal ended": "refused aborted",
        "If the goal was not accepted, log a line that contains `rejected`, and return an empty list.": "refused",
        "Log or print the name of the status": "aborted",
        "The given `on_feedback` logs each feedback message.": "feedback",
        "Return the sequence as a list.": "result",
        "wait for the result, at most `RESULT_PATIENCE` seconds": "",
    },
    counts={
        "result": "Return or log it, as any kind of sequence.",
        "refused": "An exception with the word `rejected` counts as well.",
        "aborted": "`status: 6` counts as well. You may leave out `succeeded`.",
        "limit": giving_up.COUNTS,
    },
)
