"""The recipe for a quest: a program finds something on the graph of a robot that the judge draws, and names it.

The judge draws the robots, so no program can know the answer. What has to be found may come late, or not exist: a
subject that looks once, without a limit, or that says nothing is noticed.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import asdict, replace
from random import Random
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import re2

from autograder.kit import giving_up
from autograder.kit.bench import Pace
from autograder.kit.draft import OWN, OWN_LATE, Draft
from autograder.kit.evidence import Part
from autograder.kit.giving_up import LATENESS, PATIENCE, PATIENCES
from autograder.kit.lateness import SOON
from autograder.kit.mistakes import unfinished
from autograder.kit.mistakes.crashes import CRASHES, OTHER_CRASHES, OTHER_SLIPS, what_and_where
from autograder.kit.mistakes.hangs import ENDLESS_LOOP
from autograder.kit.model import Advice, Finding, Mistake, card_words, mistake
from autograder.kit.quests.robot import Robot, Search

if TYPE_CHECKING:
    from autograder.kit.bench import Bench
    from autograder.kit.evidence import Evidence
    from autograder.kit.model import Exercise

Searches = Mapping[str, Search]
"""All runs of a subject, by the names of the robots."""

ANSWERING = {Pace.FAST: 8.0, Pace.REAL_TIME: 15.0}
"""Seconds of wall time for an answer; discovery takes up to three in a process that has just started."""
APPEARS = 12.0
"""Seconds of wall time for a subject to have a node, beside those of a robot."""
LOOKS = 4
"""Looks at the graph after which a subject will certainly look again: what comes late need not be later than that.

A subject that looks this often and then gives up has not kept its patience if there is nothing to find.
"""
PATIENCE_IN_LATE = (4.0, 5.0)
"""The range of the patience that a function is told if something comes late."""
PATIENCE_ELSEWHERE = {Pace.FAST: (0.4, 0.48), Pace.REAL_TIME: PATIENCES}
"""The range if everything exists from the start, and if there is nothing to find, so that the patience does not reveal
which. No usual constant from 2 seconds on lies in one of these.
"""
LONGEST_QUOTE = 200
"""The most characters of a line that a card quotes."""
UNKNOWN_NODE = "_NODE_NAME_UNKNOWN_"
"""The node name that the graph gives for an endpoint before it has discovered the node (rmw_dds_common)."""
ACCEPTED = "You may print the dictionary instead. A value may be a list of one name or type."
"""The other forms of an answer with several keys that count. A list of several is a guess."""
_NO_SUCH_NODE = re2.compile("NodeNameNonExistentError|Failed to get action server names and type")
"""Matches the words of rclpy's errors about a node that is not on the graph: also those about its actions."""
_GAVE_UP = re2.compile(r"(?m)^TimeoutError(?:: .*)?$")

_WORDS = card_words(__file__)


class Quest:
    """The recipe for a quest. Criteria and mistakes get all runs as :class:`Search`, by the names of the robots.

    The recipe recognizes the mistakes ``other_namespace``, ``looked_too_early``, ``wrong_node``, ``not_returned``,
    ``looked_once``, ``invented_answer``, ``waits_forever``, ``silent_end``, ``patience_not_kept``, ``gave_up``,
    ``no_answer``, ``never_ended``.

    Args:
        draws: Draws the robots by name, in the order in which the subject meets them. The names are the same each time.
        noun: The word for what there may not be, such as ``"service"``.
        next_steps: What the student should do now, by the key of a mistake, if this task needs other words than usual.

    Example::

        def robots(random: Random) -> dict[str, Robot]:
            called, obeys = random.choice(("mia", "noa", "ada")), random.choice(("go", "drive", "steer"))
            nodes = {f"/{called}/motors": {"subscribes": {f"/{called}/{obeys}": "geometry_msgs/msg/Twist"}}}
            return {"a robot": Robot(answer={"robot": called, "topic": f"/{called}/{obeys}"}, nodes=nodes)}

        EXERCISE = Quest(robots).exercise(
            "lab_8_1.obeys",
            "Lab 8.1 · What it obeys",
            "Find what a robot obeys.",
            finds={"robot": "Finds what it is called", "topic": "Finds the topic that it obeys"},
        )
    """

    roles = ()

    def __init__(
        self,
        draws: Callable[[Random], Mapping[str, Robot]],
        noun: str = "robot",
        next_steps: Mapping[str, str] = MappingProxyType({}),
    ) -> None:
        self._draws, self._noun, self._names = draws, noun, tuple(draws(Random(0)))
        self._next_steps = next_steps
        self._has_keys = False

    def seen(self, evidence: Evidence) -> Searches:
        """Return all runs of the subject, also those that were not reached."""
        return {name: Search(evidence.part(name)) for name in self._names}

    expected = seen  # each robot says what is right

    def exercise(
        self,
        exercise_id: str,
        title: str,
        task: str,
        *,
        finds: Mapping[str, str],
        gives_up: str = "",
        **more: Any,
    ) -> Exercise:
        """Return the exercise about an answer with several keys, each of which is a criterion.

        Args:
            exercise_id: The lab's folder and the file's name, as in :class:`autograder.kit.draft.Draft`.
            title: The title of the card.
            task: One sentence that states the task.
            finds: The line of the card for each key of the answer.
            gives_up: The line of the card, worth two points, for a robot without anything to find: a function raises
                TimeoutError after ``patience_sec`` seconds. A program has to end, and is never made to wait.
            more: See :meth:`autograder.kit.draft.Draft.exercise`.
        """
        self._has_keys = True
        draft = Draft(exercise_id, title, task, self)
        for key, line in finds.items():
            draft.asks(key, line, self.finds(key))
        if gives_up:
            draft.asks("limit", gives_up, self.gives_up, points=2)
        return draft.exercise(**{"counts": {"": ACCEPTED}, **more})

    # --- the scenario --------------------------------------------------------------------------------------------

    def scenario(self, bench: Bench) -> None:
        """Let the subject meet each robot."""
        robots = self._draws(bench.random)
        takes_patience = any(robot.late or not robot.answer for robot in robots.values())
        for name, robot in robots.items():
            if not robot.answer and bench.keep(name):
                continue
            if self._has_keys and not bench.in_a_cell:
                robot = replace(robot, late=())
            long = robot.late or (self._has_keys and robot.answer)
            between = PATIENCE_IN_LATE if long else PATIENCE_ELSEWHERE[bench.pace]
            patience = {PATIENCE: giving_up.drawn_patience(bench, between)} if takes_patience else {}
            bench.part(name, **asdict(robot), **patience)
            self._meets(bench, robot, patience, LATENESS)
            search = Search(bench.seen())
            gave_up = search.part.ending and not search.gave_up_at_once
            if robot.late and not search.has() and gave_up:
                bench.again()
                self._meets(bench, robot, patience, SOON)
            search = Search(bench.seen())
            bench.stop()
            each_needs_all = robot.answer and (self._has_keys or not takes_patience)
            if each_needs_all and not (search.given and search.has_answered):
                return

    def _meets(self, bench: Bench, robot: Robot, patience: Mapping[str, float], lateness: float) -> None:
        _put(bench, robot, late=False)
        bench.start(*robot.asked, **patience)
        if not robot.answer:
            giving_up.await_it(bench)
            return
        if robot.late:
            bench.await_node()
            # The robot's own nodes are on the graph as well.
            bench.watch_graph(lambda evidence: bool(Search(evidence.main).since_it_appeared.events), APPEARS)
            bench.run_time(lateness, until=lambda: len(bench.seen().of("looked")) >= LOOKS)
            if bench.await_end(0.0):
                return
            _put(bench, robot, late=True)
        if bench.wait_until(lambda evidence: Search(evidence.main).has_answered, ANSWERING[bench.pace]):
            bench.await_end(0.5)
        elif robot.answer:
            bench.note_where_it_hangs()

    # --- criteria ------------------------------------------------------------------------------------------------

    def finds(self, *keys: str, robot: str = "") -> Callable[[Evidence], Finding]:
        """Return the criterion that the subject finds, on all robots or on one, what the keys name.

        Args:
            keys: Keys of the answer; all by default.
            robot: The name of the only robot that counts. If there is a robot that comes late, then a subject that
                looks once finds the others only by chance.
        """

        def judge(evidence: Evidence) -> Finding:
            seen = self.seen(evidence)
            searches = [seen[robot]] if robot else [s for s in seen.values() if not s.finds_nothing]
            findings = [_finding(search, keys) for search in searches]
            finding = next((finding for finding in findings if not finding.passed), findings[0])
            chance = "it looks once, and what a first look finds is chance"
            looks_once = finding.passed and _looked_once(seen)
            return Finding(False, finding.expected, chance) if looks_once else finding

        return judge

    def says_that_there_is_none(self, evidence: Evidence) -> Finding:
        """Decide whether the subject says so and ends if there is nothing to find; it must find what exists."""
        seen = self.seen(evidence)
        absent = _absent(seen)
        wrong = giving_up.objection(absent, _found(seen))
        if absent.ending and (named := Search(absent).given):
            wrong = f"named {', '.join(named.values())}"
        if not any(s.has() and (s.robot.late or not _looked_once(seen)) for s in seen.values()):
            # A subject that finds nothing in any run has not shown that it looked.
            wrong = f"no other run shows that it finds a {self._noun}"
        did = "says again and again that it looks" if giving_up.goes_on_waiting(absent) else "it did"
        return Finding(not wrong, f"says {giving_up.NOT_AVAILABLE} and ends by itself", wrong or did)

    def gives_up(self, evidence: Evidence) -> Finding:
        """Decide whether the subject gives up in time if there is nothing to find; it must find what exists."""
        seen = self.seen(evidence)
        wrong = Search(_absent(seen)).limit_fault
        there = [search for search in seen.values() if search.robot.answer]
        if not all(search.has(*list(search.robot.answer)[:1]) for search in there) or _looked_once(seen):
            wrong = "it does not find what exists, so this shows nothing"
        return Finding(not wrong, "ends in time, with a TimeoutError", wrong or "it did")

    # --- mistakes ------------------------------------------------------------------------------------------------

    @property
    def ladder(self) -> tuple[Mistake, ...]:
        """The mistakes of a quest, most specific first, among the common ones."""
        return (
            self._mistake("other_namespace", _other_namespace),
            self._mistake("looked_too_early", _asked_too_early),
            self._mistake("not_written", _is_silent, certain=True),
            *CRASHES,
            OWN,
            self._mistake("wrong_node", _astray),
            self._mistake("not_returned", _not_returned, certain=True),
            self._mistake("invented_answer", _invented),
            *OTHER_SLIPS,
            unfinished.USAGE_MESSAGE,
            self._mistake("looked_once", _looked_once, certain=True),
            self._mistake("waits_forever", lambda seen: giving_up.waits_in_silence(_absent(seen))),
            Mistake("silent_end", self._silent_end, certain=True),
            self._mistake("patience_not_kept", lambda seen: giving_up.broken_patience(_absent(seen))),
            OWN_LATE,
            *OTHER_CRASHES,
            self._mistake("gave_up", _gave_up),
            self._mistake("no_answer", _no_answer),
            # A function that looks without a pause uses the processor, too, as long as it is right to look.
            replace(ENDLESS_LOOP, certain=False),
            self._mistake("never_ended", _never_ended),
            # Without its last one, "ended too early": a subject that has found everything ends.
            *unfinished.NOTHING_THERE[:-1],
        )

    def _mistake(self, key: str, found: Callable[[Searches], object], *, certain: bool = False) -> Mistake:
        says, usual = _WORDS[key]
        next_step = self._next_steps.get(key, usual)
        return mistake(key, lambda evidence: found(self.seen(evidence)), says, next_step, certain=certain)

    def _silent_end(self, evidence: Evidence) -> Advice | None:
        seen = self.seen(evidence)
        if not self._has_keys:
            return giving_up.silent_end(_absent(seen), _found(seen), self._noun)
        says, next_step = _WORDS["silent_end"]
        fault = Search(_absent(seen)).limit_fault
        return Advice(says.format(fault), next_step) if fault.startswith(("returned", "raised")) else None


def _put(bench: Bench, robot: Robot, *, late: bool) -> None:
    """Put the robot on the graph, or the part of it that comes late."""
    for node, ends in robot.nodes.items():
        if (node in robot.late) is late:
            bench.plant(node, **{"publishes": {}, "subscribes": {}, **ends})
    for service, kind in robot.services.items():
        if (service in robot.late) is late:
            bench.serve(service, kind, lambda _: {})


def _finding(search: Search, keys: Sequence[str]) -> Finding:
    answer, given = search.robot.answer, search.given
    keys = keys or tuple(answer)
    expected = ", ".join(answer[key] for key in keys if key in answer) or "an answer"
    if search.has(*keys) and not search.returned:
        return Finding(False, expected, "named it, and did not return it")
    if search.has(*keys) and search.part.ending is not None and search.part.ending.name == "raised":
        return Finding(False, expected, f"named it, and then raised {what_and_where(search.part.traceback)}")
    said = ", ".join(given.get(key, "nothing") for key in keys) if given else search.in_words
    return Finding(search.has(*keys), expected, said)


def _absent(seen: Searches) -> Part:
    """Return the run in which there is nothing to find; an empty one if there is none."""
    return next((search.part for search in seen.values() if search.finds_nothing), Part(""))


def _found(seen: Searches) -> list[Part]:
    """Return the runs with something from the start that the subject has found."""
    return [search.part for search in seen.values() if search.has() and not search.robot.late]


def _looked_once(seen: Searches) -> list[Search]:
    return [search for search in seen.values() if search.robot.late and search.gave_up_at_once]


# --- what shows a mistake ------------------------------------------------------------------------------------


def _wrong(seen: Searches) -> list[Search]:
    """Return the runs with something to find that the subject has not found."""
    return [search for search in seen.values() if search.robot.answer and not search.has()]


def _other_namespace(seen: Searches) -> bool:
    asked = (search for search in seen.values() if _NO_SUCH_NODE.search(search.part.traceback))
    return any(node.count("/") > 1 for search in asked for node in search.robot.nodes)


def _asked_too_early(seen: Searches) -> bool:
    for search in seen.values():
        if _NO_SUCH_NODE.search(search.part.traceback) or UNKNOWN_NODE in search.given.values():
            return True
    return any(search.given and not any(search.given.values()) for search in _wrong(seen))


def _is_silent(seen: Searches) -> bool:
    parts = [search.part for search in seen.values() if search.part.events]
    return bool(parts) and all(part.ending and not part.said() and not part.traceback for part in parts)


def _astray(seen: Searches) -> str:
    return next((search.astray_in_words for search in seen.values() if search.astray), "")


def _not_returned(seen: Searches) -> Search | None:
    return next((search for search in seen.values() if search.has() and not search.returned), None)


def _invented(seen: Searches) -> tuple[str] | None:
    """Return in words of which key the value is the same each time; empty words for the whole answer."""
    # With several keys, a subject has no answer if there is nothing to find.
    keys = dict.fromkeys(key for search in seen.values() for key in search.robot.answer)
    searches = [search for search in seen.values() if search.robot.answer or len(keys) < 2]
    first, *others = [search.given for search in searches]
    if first and others and all(given == first for given in others):
        return ("",)
    one = (key for key in keys if _is_one(s.given.get(key) for s in searches))
    wrong = (key for key in one if not _is_one(s.robot.answer.get(key) for s in searches))
    return next(((f" for {key}",) for key in wrong if len(keys) > 1), None)


def _is_one(values: Iterable[object]) -> bool:
    """Return True if all values are the same, and there is one."""
    return len(different := {*values}) == 1 and None not in different


def _gave_up(seen: Searches) -> object:
    waited = [_GAVE_UP.search(search.part.traceback) for search in _wrong(seen) if not search.given]
    words = [line[0] for line in waited if line]
    made = sum(bool(search.part.events) for search in seen.values())
    # After a first run without any answer there is no other one.
    return words and (f" in {len(words)} of the {made} runs" if made > 1 else "", words[0])


def _no_answer(seen: Searches) -> object:
    for search in _wrong(seen):
        missing = [key for key in search.robot.answer if key not in search.given]
        if search.part.ending and missing:
            said = [line for line in search.part.said() if line != "None" and len(line) <= LONGEST_QUOTE]
            last = f": the last that it said is “{said[-1]}”" if said else ""
            keys = ", ".join(search.robot.answer)
            wanted = f"a dictionary with the keys {keys}" if "," in keys else "the name"
            if search.given:
                return f"answer has no single value for {', '.join(missing)}", wanted
            return f"function ended without an answer{last}", wanted
    return None


def _never_ended(seen: Searches) -> bool:
    return any(search.part.events and not search.has_answered for search in _wrong(seen))
