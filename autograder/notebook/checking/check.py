"""The function ``check``: runs the subject when the judge requests it, shows the card, and returns the points."""

from __future__ import annotations

import contextlib
import inspect
import os
from typing import TYPE_CHECKING, Any

from autograder import check_journal, course
from autograder.cards import html_rendering
from autograder.cards.certificate import Certificate
from autograder.messages import judge_messages as messages
from autograder.messages import run_messages
from autograder.notebook.cell_output import notebook_shell, say
from autograder.notebook.cell_runs import raise_if_stale
from autograder.notebook.checking.card_display import (
    CardDisplay,
    Progress,
    is_live,
)
from autograder.notebook.checking.judge_link import CheckContext, JudgeLink, JudgeUnreachable
from autograder.notebook.checking.nbgrader_validation import is_validating, raise_unless_full
from autograder.notebook.checking.subject_reports import CapturedOutput, ToldCalls
from autograder.notebook.checking.subject_runs import (
    PathRun,
    SubjectRun,
    Tell,
    code_digest,
    is_path,
    own_lines_of,
    send_sources,
)
from autograder.notebook.nodes.ros_session import prepare_environment
from autograder.verdict import Verdict, not_checked
from autograder.workspaces.sources import full_disk

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from autograder.messages.json_lines import Message


class Score(float):
    """The points of a check, as the value of the check cell.

    The value's plain text is the number of points, because nbgrader reads the points from there. The value's HTML is
    empty, so that a notebook does not show the number again below the card.
    """

    def _repr_html_(self) -> str:
        return '<span class="agc-cell-value" hidden="hidden"></span>'


LINE = 70
"""The maximum number of characters of a line of output that the card shows while a check goes on."""


_after_a_check: list[Callable[[Verdict, Any], None]] = []


def after_each_check(then: Callable[[Verdict, Any], None]) -> None:
    """Register a function that is called with the verdict and the subject of each check in a cell."""
    _after_a_check.append(then)


def check(exercise: str, subject: Any) -> float:
    """Let the judge check a subject, and show the verdict as a card.

    Args:
        exercise: The exercise's id, such as ``"lab_1_2.talker"``.
        subject: A class derived from ``Node``, or a function; not an instance and not the result of a call. For
            an exercise about files, the path of the workspace or of the launch file.

    Returns:
        The points earned. In the sandbox of a submission always 0, because the judge tells only the grader the points.

    Raises:
        TypeError: The subject is neither a class nor a function nor a path. The message says what to write instead.
        StaleCodeError: The cell that redefines the subject ended with an error, so the check would judge the old
            code.
    """
    if not (inspect.isclass(subject) or callable(subject) or is_path(subject)) or is_quoted(subject):
        raise TypeError(what_to_pass(exercise, subject))
    if is_live():
        raise_if_stale(subject)
    prepare_environment()
    with CardDisplay(exercise, subject) as card, _plainly_interrupted():
        verdict = _ask(exercise, subject, card.progress)
        if verdict is None:
            return Score(0.0)
        # Record the check first: the card reads the journal, and validation may end the cell with an error.
        with recorded(verdict, subject):
            card.show(verdict)
    if is_validating():
        raise_unless_full(verdict)
    for then in _after_a_check:
        then(verdict, subject)
    return Score(verdict.score)


@contextlib.contextmanager
def _plainly_interrupted() -> Iterator[None]:
    """Make IPython show an interrupt in one line, because the frames of the check tell a student nothing."""
    try:
        yield
    except KeyboardInterrupt as interrupt:
        interrupt._render_traceback_ = lambda: ["KeyboardInterrupt"]  # type: ignore[attr-defined]
        raise


def _ask(exercise: str, subject: Any, progress: Progress) -> Verdict | None:
    if is_live() and is_path(subject) and (trouble := full_disk(subject)):
        return not_checked(exercise, exercise, 0.0, trouble, key="disk_full")
    try:
        link = JudgeLink()
    except JudgeUnreachable as error:
        return not_checked(exercise, exercise, 0.0, str(error))
    try:
        return converse(link, exercise, subject, progress)
    except JudgeUnreachable as error:
        return not_checked(exercise, exercise, 0.0, str(error), "Run the cell again.")
    finally:
        link.close()


def converse(link: JudgeLink, exercise: str, subject: Any, progress: Progress) -> Verdict | None:
    """Carry out the judge's requests, then return the verdict; None if the judge reports only to the grader.

    Args:
        link: The connection to the judge.
        exercise: The exercise's id.
        subject: The class, function or path to check.
        progress: Receives the steps of the check.

    Raises:
        JudgeUnreachable: The judge has ended, or the link was closed.
    """
    link.say(messages.Check(exercise, kind=_kind(subject)))
    if is_live():
        html_rendering.templates()  # prepare the card while the judge makes its node
    first = link.hear()
    if isinstance(first, messages.Collect):
        # A grader builds and runs workspaces and launch files itself, so only their sources are sent.
        send_sources(link.say, subject)
        return _verdict_in(exercise, link.hear())
    if not isinstance(first, messages.Begin):
        return _verdict_in(exercise, first)
    link.say(own_lines_of(subject))
    run: SubjectRun | PathRun | None = None
    number = 0

    def tell(kind: Callable[..., Message], **data: Any) -> None:
        link.say(kind(number, **data))

    with (
        CheckContext(first.domain, first.keeper) as check_context,
        CapturedOutput(lambda line, logged: tell(run_messages.Output, text=line, logged=logged)) as captured,
        ToldCalls(captured.is_captured, tell) as calls,
    ):
        link.say(run_messages.Ready())
        try:
            while True:
                match order := link.hear():
                    case messages.Meet():
                        check_context.ensure(fresh=order.fresh)
                        link.say(
                            messages.EndpointsMet(check_context.sees(order.there, order.gone, order.within))
                        )
                    case run_messages.Start():
                        # Only a class or function runs in this kernel's context. A path runs in a new process.
                        if not is_path(subject):
                            check_context.ensure(fresh=order.fresh)
                        number = order.run
                        progress.doing(f"run {number} of your code")
                        run = (
                            PathRun(number, exercise, subject, first.domain, _retold(link.say, progress))
                            if is_path(subject)
                            else SubjectRun(number, subject, check_context.context, link.say)
                        )
                        calls.begin_run()
                        run.start(order.arguments, order.options)
                    case messages.Release() if run is not None:
                        run.release()
                    case run_messages.Interrupt() if isinstance(run, PathRun):
                        run.interrupt()
                    case messages.Stack() if run is not None:
                        link.say(messages.Stacks(number, *captured.stacks()))
                    case run_messages.Stop() if run is not None:
                        if not run.stop():
                            check_context.renew()  # the run still uses the old context, so the next run gets a new one
                        link.say(run_messages.Stopped(number))
                        progress.doing(f"the judge examines run {number}")
                        run = None
                    case messages.SoFar():
                        progress.take(order.verdict, order.words)
                    case messages.Judged() | messages.Refused():
                        return _verdict_in(exercise, order)
        except KeyboardInterrupt:
            progress.interrupt()
            raise
        finally:
            if run is not None:
                run.stop()


@contextlib.contextmanager
def recorded(verdict: Verdict, subject: Any) -> Iterator[None]:
    """Record a check in the journal, then let the caller show its card.

    If the check completes a chapter, show the certificate below the card. A grader's kernel has no journal. Files that
    cannot be read or written are skipped, so that they do not break a check.
    """
    ended = None
    if notebook_shell() is not None and not os.environ.get(messages.SOCKET_VARIABLE):
        with contextlib.suppress(OSError, course.NoCourse, course.BrokenChapter):
            ended = _chapter_ended_by(verdict, code_digest(subject))
    yield
    if ended is not None and is_live():
        _show_certificate(ended)


def _chapter_ended_by(verdict: Verdict, code: str) -> Certificate | None:
    """Return the certificate of the chapter that this check completed; None if it completed none."""
    journal = check_journal.session_journal_path()
    before = check_journal.best(check_journal.entries(journal))
    if not check_journal.note_check(verdict, journal, code=code) and journal is not None:
        say(f"This check is not in your progress, because {journal} cannot be written: is the disk full?")
    if journal is None or not verdict.passed:
        return None
    after = check_journal.best(check_journal.entries(journal))
    for chapter in course.chapters(course.root()):
        finished = check_journal.finished(chapter, after)
        if finished is not None and check_journal.finished(chapter, before) is None:
            tasks = [after[name] for lab in chapter.labs for name in chapter.exercises_of(lab)]
            points, helped = sum(task.possible for task in tasks), sum(task.helped for task in tasks)
            return Certificate(chapter.title, points, finished, helped)
    return None


def _show_certificate(certificate: Certificate) -> None:
    from IPython.display import display

    display(certificate.bundle(), raw=True)  # type: ignore[no-untyped-call]


def _kind(subject: Any) -> str:
    if inspect.isclass(subject):
        return "class"
    return "path" if is_path(subject) else "function"


def _verdict_in(exercise: str, answer: messages.FromJudge) -> Verdict | None:
    if isinstance(answer, messages.Judged):
        return answer.verdict
    why = answer.why if isinstance(answer, messages.Refused) else "the judge refused"
    return not_checked(exercise, exercise, 0.0, why)


def _retold(tell: Tell, progress: Progress) -> Tell:
    """Return a function that calls ``tell`` and also shows the last printed line of a program on the card."""

    def told(message: Message) -> None:
        if (
            isinstance(message, run_messages.Output)
            and message.text.strip()
            and not message.text.startswith("@")
        ):
            progress.doing(message.text.strip()[:LINE])
        tell(message)

    return told


def is_quoted(subject: Any) -> bool:
    """Return True if a string is the name of a class or function of the notebook, and so no path."""
    return isinstance(subject, str) and callable(getattr(notebook_shell(), "user_ns", {}).get(subject))


def what_to_pass(exercise: str, subject: Any, call: str = "check") -> str:
    """Return a sentence that says what to pass instead of an object that cannot be checked."""
    kind = type(subject).__name__
    names = getattr(notebook_shell(), "user_ns", {})
    if names.get(kind) is subject:
        return (
            f"{kind} is an object now, and not the class, because a line of yours says {kind} = {kind}(...). Give the "
            f"object another name there, as in node = {kind}(...), and run the cell that defines the class again."
        )
    if is_quoted(subject):
        return f"{call}({exercise!r}, {subject}) takes your class or function itself, without quotation marks"
    return f"{call}({exercise!r}, …) takes your class or function itself, without parentheses after it, not a {kind}"
