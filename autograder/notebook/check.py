"""The check cell: run the subject at the judge's word, show its card, give the score."""

from __future__ import annotations

import inspect
from typing import Any

from autograder.cards import bundle
from autograder.notebook.check_context import CheckContext
from autograder.notebook.hurry import Hurry
from autograder.notebook.judge_link import JudgeLink, JudgeUnreachable
from autograder.notebook.looking import Looking
from autograder.notebook.overhearing import Overhearing
from autograder.notebook.path_run import PathRun, is_path, send_sources
from autograder.notebook.ros_session import prepare_environment
from autograder.notebook.subject_run import SubjectRun
from autograder.verdict import Verdict, from_builtins, not_checked


def check(exercise: str, subject: Any) -> float:
    """Let the judge check a subject, and show the verdict as a card.

    Args:
        exercise: The exercise's id, such as ``"lab_1_2.talker"``.
        subject: A class derived from ``Node``, or a function; not an instance and not the result of a call. For
            an exercise about files, the path of the workspace or of the launch file.

    Returns:
        The points earned. A grader takes its points from the judge itself, not from here.

    Raises:
        TypeError: The subject is neither a class nor a function nor a path; the message says what to write instead.
    """
    if not (inspect.isclass(subject) or callable(subject) or is_path(subject)):
        raise TypeError(_what_to_pass(exercise, subject))
    prepare_environment()
    verdict = _ask(exercise, subject)
    _show(verdict)
    return verdict.score


def _ask(exercise: str, subject: Any) -> Verdict:
    try:
        link = JudgeLink()
    except JudgeUnreachable as error:
        return not_checked(exercise, exercise, 0.0, str(error))
    try:
        return _converse(link, exercise, subject)
    except JudgeUnreachable as error:
        return not_checked(exercise, exercise, 0.0, str(error), "Run the cell again.")
    finally:
        link.close()


def _converse(link: JudgeLink, exercise: str, subject: Any) -> Verdict:
    """Do what the judge says until it has a verdict."""
    link.say("check", exercise=exercise, kind="class" if inspect.isclass(subject) else "function")
    bundle.prepare()  # while the judge makes its node
    first = link.hear()
    if first["say"] == "collect":
        # A grader builds and runs what a path leads to by itself.
        send_sources(link.say, subject)
        return _last_words(exercise, link.hear())
    if first["say"] != "begin":
        return _last_words(exercise, first)
    run: SubjectRun | PathRun | None = None
    number = 0

    def tell_output(line: str) -> None:
        link.say("output", run=number, text=line)

    def tell_look() -> None:
        link.say("looked", run=number)

    with (
        CheckContext(int(first["domain"])) as place,
        Overhearing(tell_output) as hearing,
        Hurry(hearing.overhears) as hurry,
        Looking(tell_look, hearing.overhears) as looking,
    ):
        link.say("ready")
        try:
            while True:
                words = link.hear()
                say = words["say"]
                if say == "start":
                    place.ensure(fresh=bool(words.get("fresh")))
                    number = int(words["run"])
                    run = (
                        PathRun(number, exercise, subject, int(first["domain"]), link.say)
                        if is_path(subject)
                        else SubjectRun(number, subject, place.context, link.say)
                    )
                    hurry.factor = float(words.get("hurry", 1.0))
                    looking.begin_run()
                    run.start(words["arguments"], words["options"])
                elif say == "release" and run is not None:
                    run.release()
                elif say == "stack" and run is not None:
                    link.say("stack", run=number, text=hearing.stacks())
                elif say == "stop" and run is not None:
                    if not run.stop():
                        place.renew()  # what will not end keeps the old context and is no longer heard
                    link.say("stopped", run=number)
                    run = None
                elif say in ("verdict", "refused"):
                    return _last_words(exercise, words)
        finally:
            if run is not None:
                run.stop()


def _last_words(exercise: str, words: dict[str, Any]) -> Verdict:
    if words["say"] == "verdict":
        return from_builtins(words["verdict"])
    return not_checked(exercise, exercise, 0.0, str(words.get("why", "the judge refused")))


def _show(verdict: Verdict) -> None:
    from IPython.core.getipython import get_ipython
    from IPython.display import display

    card = bundle.mimebundle(verdict)
    if get_ipython() is None:
        print(card["text/plain"])
    else:
        display(card, raw=True)  # type: ignore[no-untyped-call]


def _what_to_pass(exercise: str, subject: Any) -> str:
    kind = type(subject).__name__
    return f"check({exercise!r}, …) takes your class or function itself, without brackets behind it, not a {kind}"
