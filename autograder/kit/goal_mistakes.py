"""Known mistakes of clients that send goals and tell how they ended."""

from __future__ import annotations

from typing import TYPE_CHECKING

from autograder.kit.crashes import meant, what_and_where
from autograder.kit.giving_up import gave_up, patience_not_kept
from autograder.kit.goal_reports import (
    ABORTED,
    ABSENT,
    CANCELED,
    LATE,
    MANY_REQUESTS,
    NO_GOAL,
    NOT_AWAITED,
    REFUSED,
    SERVED,
    aborted_as_seen,
    asked_for,
    called_accepted,
    given_up,
    goals_as_seen,
    left_at_once,
    miscalled,
    raised_on_purpose,
    refused_as_seen,
    reports_result,
    returned_instead,
    said_of_result,
    unshown_feedback,
)
from autograder.kit.model import Advice
from autograder.kit.texts_said import mentions

if TYPE_CHECKING:
    from autograder.kit.evidence import Evidence


def waits_for_nobody(evidence: Evidence) -> Advice | None:
    """Without a server it never ends, and does not say that it waits."""
    if not given_up(evidence).startswith("still waiting"):
        return None
    return Advice(
        f"When there is no action server, your client is {given_up(evidence)}.",
        "Give the wait a limit of a few seconds: `if not client.wait_for_server(timeout_sec=5.0):` say so and stop.",
    )


def another_patience(evidence: Evidence) -> Advice | None:
    """A function gives up at another moment than it was told."""
    return patience_not_kept(evidence.part(ABSENT))


def waits_forever(evidence: Evidence) -> Advice | None:
    """With a server that is there, it neither sends a goal nor ends."""
    part = evidence.part(LATE)
    if not part.endpoints("action_client") or part.ending is not None or asked_for(part):
        return None
    return Advice(
        "The server was there, but your client never sent a goal and never ended.",
        "Wait with a limit, `client.wait_for_server(timeout_sec=5.0)`, and send the goal as soon as it is True.",
    )


def gave_up_too_early(evidence: Evidence) -> Advice | None:
    """It ended before it had met the server."""
    served = [evidence.part(name) for name in SERVED]
    if not gave_up(served, evidence.part(ABSENT), lambda part: bool(asked_for(part))):
        return None
    return Advice(
        "The server was there, or came a moment late, and your client had already given up.",
        "Wait for it with wait_for_server and a few seconds of patience before you send the goal.",
    )


def order_never_filled(evidence: Evidence) -> Advice | None:
    """Every goal asks for order 0, also where another one was given."""
    made = [order for part in evidence if part.inputs.get("order") != 0 for order in asked_for(part)]
    if not made or any(made):
        return None
    return Advice(
        "The goal asks for order 0: its field was never filled.",
        "Set goal.order (or Fibonacci.Goal(order=...)). A misspelt keyword is ignored silently.",
    )


def wrong_order(evidence: Evidence) -> Advice | None:
    """Another order than the one given, or several goals."""
    wrong = goals_as_seen(evidence)
    if not wrong or wrong in (NO_GOAL, NOT_AWAITED, CANCELED):
        return None
    return Advice(
        f"The judge got {wrong}.",
        "Send one goal, once, with the order that your function or program was given (sys.argv[1] on a command line). "
        "If a timer sends the goal, switch the timer off after that: timer.cancel().",
    )


def canceled_unasked(evidence: Evidence) -> Advice | None:
    """It asks to cancel a goal that nobody wants canceled."""
    if goals_as_seen(evidence) != CANCELED:
        return None
    return Advice(
        "Your client asked the server to cancel its goal, on its way.",
        "The task asks for the whole goal: leave out cancel_goal_async(), and wait for the result.",
    )


def never_spun(evidence: Evidence) -> Advice | None:
    """It sent its goal, and nothing that came back was taken in."""
    part = evidence.part(LATE)
    if not asked_for(part) or part.first("result_request") is not None or not part.of("unanswered"):
        return None
    return Advice(
        "Your client sent its goal, but it receives no answer: none of its callbacks is called any more.",
        "Spin it while it waits: rclpy.spin(node) or spin_until_future_complete(node, future, timeout_sec=5.0), in one "
        "place.",
    )


def result_of_rejected_goal(evidence: Evidence) -> Advice | None:
    """It asked for a result that will never be."""
    if evidence.part(REFUSED).first("result_request") is None:
        return None
    return Advice(
        "The goal was rejected, and your client asked for its result all the same: there is none, and the status that "
        "comes back is 0, UNKNOWN.",
        "Look at goal_handle.accepted first. Where it is False, say so and stop.",
    )


def crashed_by_refusal(evidence: Evidence) -> Advice | None:
    """It goes on with a refused goal until an exception stops it, and comes through all other parts without one."""
    crashed = [part for part in evidence if part.traceback and not raised_on_purpose(part)]
    if [part.name for part in crashed] != [REFUSED]:
        return None
    return Advice(
        "The goal was rejected, and your client went on as if it had been accepted, until an exception stopped it: "
        f"{what_and_where(crashed[0].traceback)}",
        "Look at goal_handle.accepted as soon as the answer to the goal is there. Where it is False, say so, as the "
        "task asks, and stop: there is no result to wait for.",
        crashed[0].traceback,
    )


def goes_on_after_refusal(evidence: Evidence) -> Advice | None:
    """It calls a goal accepted that was refused."""
    claim = called_accepted(evidence)
    if not claim:
        return None
    return Advice(
        f"The goal was rejected, and your client said “{claim}”: it went on as if the goal had been accepted.",
        "Stop where `goal_handle.accepted` is False: below the line that says so, end with `return`.",
    )


def never_ended(evidence: Evidence) -> Advice | None:
    """It says that the goal was refused and stays."""
    if refused_as_seen(evidence) != "said so, and did not end":
        return None
    return Advice(
        "Your client says that the goal was rejected, and then waits for ever for a result that will not come.",
        "End the program there, too: shut down where you found `not goal_handle.accepted`, or spin until a future "
        "of your own is complete and set its result.",
    )


def refusal_not_reported(evidence: Evidence) -> Advice | None:
    """It does not say that the goal was refused."""
    if refused_as_seen(evidence) != "nothing was said of it":
        return None
    waits = evidence.part(REFUSED).ending is None
    return Advice(
        "The goal was rejected, and your client did not say so"
        + (": it still waits for what a rejected goal never sends." if waits else "."),
        "Look at goal_handle.accepted when the answer to the goal is there, and log an error where it is False.",
    )


def feedback_not_shown(evidence: Evidence) -> Advice | None:
    """Feedback came and was not logged."""
    part = evidence.part(LATE)
    missing = unshown_feedback(part)
    if not missing or part.first("result_request") is None:
        return None
    return Advice(
        f"{len(part.of('feedback'))} feedback messages were sent, and your client showed "
        f"{len(part.of('feedback')) - len(missing)} of them.",
        "Give send_goal_async a feedback_callback, and log message.feedback.partial_sequence in it, each time.",
    )


def ended_before_its_answers(evidence: Evidence) -> Advice | None:
    """It ended while an answer was on its way, or as soon as its goal was accepted."""
    part = evidence.part(LATE)
    ending, answered, result = part.ending, part.first("goal_answered"), part.first("result")
    if not asked_for(part) or ending is None or (part.traceback and not meant(part.traceback)):
        return None
    events = list(part.events)
    took = part.first("feedback") is not None and len(unshown_feedback(part)) < len(part.of("feedback"))
    if answered is None or (not took and left_at_once(part)):
        missing = "it could make anything of the answer"
    elif part.first("result_request") and (result is None or events.index(ending) < events.index(result)):
        missing = "the result that it had asked for was there"
    else:
        return None
    return Advice(
        f"Your client sent its goal, and ended before {missing}. An answer may take half a second and more.",
        "Spin until the answer is there: rclpy.spin_until_future_complete(node, future, timeout_sec=5.0), or "
        "rclpy.spin(node) where callbacks take the answers. A single spin_once takes in one thing only.",
    )


def result_not_requested(evidence: Evidence) -> Advice | None:
    """It never asked for the result."""
    part = evidence.part(LATE)
    if not asked_for(part) or part.first("result_request") is not None:
        return None
    return Advice(
        "Your client sent its goal and never asked for the result.",
        "Call goal_handle.get_result_async() once the goal is accepted, and wait for that future.",
    )


def result_repeated(evidence: Evidence) -> Advice | None:
    """A poll that was never stopped."""
    asked = len(evidence.main.of("result_request"))
    if asked <= MANY_REQUESTS:
        return None
    return Advice(
        f"Your client asked for the result of one goal {asked} times.",
        "Ask once, when the goal is accepted, and wait for the future that you get. If a timer checks whether the "
        "result is there, switch the timer off when it is: timer.cancel().",
    )


def wrong_result_reported(evidence: Evidence) -> Advice | None:
    """It says the last feedback once more, and takes it for the result."""
    part = evidence.part(LATE)
    result, feedback = part.first("result"), part.of("feedback")
    if result is None or reports_result(part) or not feedback:
        return None
    if not mentions(said_of_result(part), feedback[-1].data["fields"]["partial_sequence"][-1]):
        return None
    return Advice(
        "Your client reported the last feedback as if it were the result; the result was another sequence.",
        "Take the sequence from the result: future.result().result.sequence.",
    )


def another_returned(evidence: Evidence) -> Advice | None:
    """A function says the sequence, and returns something else."""
    part = evidence.part(LATE)
    result = part.first("result")
    if result is None or not reports_result(part):
        return None
    returned = returned_instead(part, result.data["fields"]["sequence"])
    if not returned:
        return None
    return Advice(
        f"Your function logged the sequence of the result, and returned {returned}.",
        "End it with `return list(answer.result.sequence)`: whoever calls it wants the numbers.",
    )


def refusal_returned(evidence: Evidence) -> Advice | None:
    """A function says that the goal was refused, and does not return an empty list."""
    returned = returned_instead(evidence.part(REFUSED), [])
    if refused_as_seen(evidence) or not returned:
        return None
    return Advice(
        f"The goal was rejected, your function said so, and then it returned {returned}.",
        "Where the goal is rejected there is no sequence: `return []`, an empty list.",
    )


def status_misreported(evidence: Evidence) -> Advice | None:
    """It calls a goal canceled or aborted that has succeeded."""
    wrong = miscalled(evidence.part(LATE))
    if not wrong:
        return None
    return Advice(
        f"The goal succeeded (status 4), but your client said “{wrong}”.",
        "Look the number up in GoalStatus (from action_msgs.msg): 4 is SUCCEEDED, 5 is CANCELED, 6 is ABORTED.",
    )


def result_not_reported(evidence: Evidence) -> Advice | None:
    """The result came and was not said."""
    part = evidence.part(LATE)
    result = part.first("result")
    if result is None or part.first("result_request") is None or reports_result(part):
        return None
    numbers, said = result.data["fields"]["sequence"], said_of_result(part)
    left_out = [number for number in numbers if not mentions(said, number)]
    if len(left_out) < len(numbers) / 2:
        seen = (
            f"{left_out[-1]} is missing"
            if left_out
            else "not in their order, or one that is there twice only once"
        )
        return Advice(
            f"The result has {len(numbers)} numbers. Your client said most of them, but not all as they came: {seen}.",
            "Say the whole sequence, as the server sent it: list(future.result().result.sequence).",
        )
    return Advice(
        "The result came, but your client did not say its sequence.",
        "When the result is there, log future.result().result.sequence (and in the notebook return it).",
    )


def abort_not_reported(evidence: Evidence) -> Advice | None:
    """An aborted goal sounds like one that succeeded."""
    wrong = aborted_as_seen(evidence)
    if not wrong or evidence.part(ABORTED).first("result_request") is None:
        return None
    return Advice(
        f"The goal was aborted (status 6), but what your client said of it is the same as for a success: {wrong}.",
        "Look at the status that comes with the result: say its name, ABORTED, or compare it with "
        "GoalStatus.STATUS_SUCCEEDED (from action_msgs.msg).",
    )


def silent_end(evidence: Evidence) -> Advice | None:
    """Without a server it ends, and says nothing."""
    if given_up(evidence) != "ended without a word" or not asked_for(evidence.part(LATE)):
        return None
    return Advice(
        "When there is no action server, your client ends without a word.",
        "Log an error (or raise TimeoutError) before you return.",
    )
