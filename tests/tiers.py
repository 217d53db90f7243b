"""The tiers: what ``./course test`` runs, and with ``--changed``, ``--smoke`` and ``--all``. Decided here alone.

A test in ``NIGHTLY`` is left to ``--all``. Of those in ``DRAWS`` some run, which the commit decides, of these the short
tier runs no more than ``SHORT`` says, and it runs all that are marked ``due``: something that they depend on has
changed. ``--changed`` runs those that are drawn and reach a change (``tests/reach/``), of the longest of them only as
many as ``LONG`` says, and those of ``SMOKE``, which ``--smoke`` runs alone. A contributor who names files or folders of
tests gets all of them.
"""

from __future__ import annotations

import functools
import os
import subprocess
from collections import defaultdict
from pathlib import Path
from random import Random
from typing import TYPE_CHECKING, Any

import pytest

from tests.turns import GRAPH, LIVE, SHORT, Draw

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

SEED = "COURSE_TEST_DRAW"
"""The variable that repeats a draw: the abbreviated hash of a commit, or any other word."""

NIGHTLY = (
    # Killed and interrupted: each kills a whole batch, again and again.
    "tests/grading/day/test_killed_at_random.py::test_collect_is_ended_and_goes_on[20]",
    "tests/grading/day/test_killed_at_random.py::test_grade_is_ended_and_goes_on",
    "tests/grading/running/test_order_executor.py::test_a_killed_batch",
    "tests/grading/running/test_order_executor.py::test_fork_servers_that_die",
    # Servers of others, which few classes use.
    "tests/grading/cluster/test_cluster.py",
    "tests/grading/cluster/test_cluster_worker.py",
    "tests/grading/test_postgresql.py",
    # What is measured, and again and again.
    "tests/measure/test_run_all.py::test_what_can_be_run_again_and_what_cannot",
    "tests/mutation/test_mutation.py::test_every_operator_makes_something",
    "tests/mutation/test_mutation.py::test_no_two_mutants_mean_the_same_and_none_means_the_original",
    # All mutants of all right answers, 24,000: that each has an id, a row of the table its mutant, a sample its share.
    "tests/mutation/test_mutation.py::test_ids_are_unique_and_every_exercise_has_its_mutants",
    "tests/mutation/test_mutation.py::test_every_equivalent_is_still_made",
    "tests/mutation/test_mutation.py::test_a_sample_is_the_same_each_time_and_takes_from_every_exercise",
    "tests/benchmarks/test_short_run.py",
    "tests/measure/test_compare.py::test_two_commits_are_judged_each_by_its_own_judge",
    "tests/mutation/test_mutation.py::test_a_sample_of_mutants_is_caught",
    # Each takes up to 40 s of two processors, as `record` does, which an author runs.
    "tests/authoring/mutants/test_survey.py::test_each_exercise_of_the_course_is_ready",
    # Commands of nbgrader itself, each of which takes seconds to start; what they end in is tested within the process.
    "tests/grading/new_classes/test_new_class.py::test_its_gradebook_has_the_version_that_nbgraders_own_would_have",
    "tests/grading/table/test_spreadsheet_csv.py::test_plain_nbgrader_export_is_defused_too",
    "tests/masters/test_equals_nbgrader.py::test_the_command_gives_the_same_bytes",
    # Three programs and all their mistakes, at each missing event; each program's own exercise is tried in both tiers.
    "tests/judge/test_missing_events.py::test_no_exercise_needs_an_event_to_come_to_a_verdict[lab_1_4.programs]",
    # All notebooks in one folder; two of them are executed in both tiers.
    "tests/masters/test_run_again.py",
    # The same three programs and their mistakes, with whatever a subject can do.
    "tests/judge/test_hostile_subjects.py::test_no_subject_ends_its_judge[lab_1_4.programs]",
    # The longest exercise at each missing event, a hundred seconds; the others stay.
    "tests/judge/test_missing_events.py::test_no_exercise_needs_an_event_to_come_to_a_verdict[bugs_2.counting_clock]",
    # Recording what builds packages, or a changed exercise; what has changed in truth is recorded in both tiers.
    # And recording many wrong answers, each in a run of a judge: up to eighty seconds of a processor. The others take
    # the same way with one or two, and test_bank.py judges each wrong answer from what was seen of it.
    "tests/authoring/test_reference_files.py::test_recording_again_gives_the_same_file[many-",
    "tests/authoring/test_reference_files.py::test_recording_again_gives_the_same_file[lab_1_2.programs]",
    "tests/authoring/test_reference_files.py::test_recording_again_gives_the_same_file[lab_1_3.programs]",
    "tests/authoring/test_reference_files.py::test_recording_again_gives_the_same_file[lab_1_4.programs]",
    "tests/authoring/test_reference_files.py::test_a_changed_reference_solution_changes_what_is_expected",
    "tests/authoring/test_reference_files.py::test_inputs_that_were_changed_and_not_recorded_again_are_noticed",
    "tests/grading/test_course_version.py::test_a_changed_byte_in_any_of_them_moves_it",
    # A chapter and an exercise of somebody else's; the first steps of one are in both tiers.
    "tests/authoring/test_new_exercise.py::test_an_exception_of_the_exercise_is_named_with_its_line",
    "tests/authoring/test_new_exercise.py::test_a_point_for_what_is_given_is_found",
    "tests/authoring/test_new_exercise.py::test_each_recipe_makes_a_lab_that_is_recorded_built_and_executed",
    "tests/authoring/test_new_exercise.py::test_what_is_expected_does_not_change_unasked",
    # The example with the most mutants, as long as the others together; one of the others is tried in both tiers.
    "tests/authoring/test_new_exercise.py::test_an_example_is_in_step_and_judged_as_its_author_expects[oracle]",
    "tests/test_second_chapter.py",
    "tests/test_wheel.py::test_an_exercise",
    "tests/test_adding_an_exercise.py::test_the_page_does_what_it_says",
    "tests/test_first_exercise.py::test_the_page_does_what_it_says",
    # A browser, but for the first minutes and for texts that nobody may trust.
    "tests/browser/test_accessibility.py",
    "tests/browser/test_autograde_button.py",
    "tests/browser/test_course_page.py",
    "tests/browser/test_first_minutes.py::test_the_arrow_keys",
    "tests/browser/test_lab_1_2.py",
    "tests/browser/test_narrow.py",
    "tests/browser/test_opening.py",
    "tests/browser/test_the_day.py",
    "tests/browser/test_untrusted_pages.py::test_feedback_by_plain_nbgrader",
    "tests/browser/test_untrusted_pages.py::test_the_texts_do_what_they_are_meant_to_where_nobody_cleans_them",
    "tests/browser/test_watch.py",
    # Builds of workspaces, of which the first and the failing one stay.
    "tests/workspaces/test_paths_in_a_box.py::test_a_right_interface_is_built_in_the_box",
    "tests/workspaces/builds/test_colcon.py::test_a_changed_byte_is_another_build",
    "tests/workspaces/builds/test_colcon.py::test_what_an_earlier_build_left_behind_has_no_part_in_it",
    "tests/workspaces/builds/test_colcon.py::test_a_merged_install_is_left_alone",
    "tests/workspaces/builds/test_colcon.py::test_packages_of_others_stay",
    "tests/workspaces/builds/test_colcon.py::test_what_is_half_done_beside_the_package_hurts_only_who_needs_it",
    "tests/workspaces/builds/test_colcon.py::test_what_a_package_depends_on_may_fail",
)
"""Beginnings of the ids of tests that only ``--all`` runs."""


BUILT = (
    "exercise_1_1.package",
    "exercise_1_1.remap",
    "lab_1_1.hello",
    "lab_1_2.programs",
    "lab_1_3.interface",
    "lab_1_3.programs",
    "lab_1_4.programs",
)
"""Exercises whose answers are built or launched: seven seconds of a processor each, where others take two."""
DRAWS = (
    Draw("tests/judge/test_hostile_subjects.py::test_no_subject_ends_its_judge[", 12),
    Draw(f"{LIVE}[", 1, "/"),
    Draw("tests/attacks/test_attacks.py::test_it_is_defeated[", 1, "-"),
    Draw("tests/test_left_behind.py::test_everything_ends_with_the_command[", 1, "-"),
    Draw("tests/authoring/test_reference_files.py::test_recording_again_gives_the_same_file[", 1),
    Draw("tests/grading/new_classes/test_sample_class.py::test_every_sample_earns_what_it_must[", 3),
    Draw("tests/workspaces/test_graded_notebooks.py::test_the_master_gets_full_marks[", 1),
    Draw(
        "tests/workspaces/builds/test_plain_packages.py::test_the_files_of_each_package_of_the_bank_are_those_of_colcon[",
        1,
    ),
    Draw("tests/masters/test_programs.py::test_the_program_earns_full_marks[", 2),
    Draw("tests/notebook/checking/test_patience_in_cells.py::test_who_keeps_the_patience_is_right[", 2),
    Draw("tests/notebook/checking/test_patience_in_cells.py::test_who_waits_by_another_limit_is_wrong[", 2),
    Draw("tests/notebook/checking/test_starts_in_two_phases.py::test_a_node_may_make_its_endpoint", 2),
    Draw("tests/notebook/checking/test_starts_in_two_phases.py::test_a_node_that_can_make_nothing_more", 1),
    Draw("tests/notebook/checking/test_working_constructors.py::test_what_works_in_its_constructor", 1),
    Draw("tests/notebook/checking/test_working_constructors.py::test_what_is_wrong_there_is_told", 1),
    Draw("tests/browser/test_restart.py::", 1),
    Draw(GRAPH, 4),
    Draw("tests/environment/ros2_command/test_launch_nodes.py::test_nodes_with_remapping", 1),
    Draw("tests/grading/test_fail_closed.py::test_a_disk_that_is_full_at_any_moment[", 4),
    Draw(
        "tests/grading/test_nbgrader_and_ours.py::test_a_command_of_plain_nbgrader_ends_with_the_exit_code_of_ours[",
        1,
    ),
    Draw("tests/grading/test_result_writer.py::test_nbgraders_own_steps_find_nothing_to_change[", 1),
    Draw(
        "tests/grading/returning/test_figures_on_pages.py::test_a_page_shows_every_figure_of_the_chapter[", 1
    ),
    Draw(
        "tests/authoring/test_new_exercise.py::test_an_example_is_in_step_and_judged_as_its_author_expects[",
        1,
    ),
    Draw("tests/authoring/test_notebooks.py::test_master_and_chapter_show_what_they_have_to[", 2),
)


SMOKE = (
    # An answer to an exercise of each role, judged itself.
    *(
        Draw(f"{LIVE}[{exercise}/right/", 1)
        for exercise in ("lab_1_2.talker", "lab_1_2.listener", "lab_1_3.server", "lab_1_3.client")
    ),
    *(
        Draw(f"{LIVE}[{exercise}/right/", 1)
        for exercise in ("lab_1_4.server", "lab_1_4.client", "exercise_1_1.package")
    ),
    # An attack on each layer of the box, and a class of three notebooks.
    *(
        Draw(f"tests/attacks/test_attacks.py::test_it_is_defeated[{family}-", 1)
        for family in ("forging", "socket", "reading", "writing", "breaking", "network", "shadowing")
    ),
    Draw("tests/attacks/test_attacks.py::test_an_honest_student_has_what_was_earned", 9),
    Draw("tests/grading/new_classes/test_sample_class.py::test_every_sample_earns_what_it_must[", 3),
    Draw("tests/grading/new_classes/test_sample_class.py::test_gradebook_csv_and_feedback_say_the_same", 1),
    # What reads the whole repository, or a page of which any command may be typed.
    *(Draw(f"tests/test_{name}.py::", 1000) for name in ("docs", "english", "imports", "size", "tiers")),
)
"""Tests that run whatever has changed."""
LONG = (
    Draw(f"{LIVE}[", 8),
    Draw("tests/judge/test_missing_events.py::", 8),
)
"""Of these, ``--changed`` runs no more than so many, if more of them reach the change."""


@functools.cache
def _commit() -> str:
    """The abbreviated hash of the commit that is checked out; a fixed word outside of a clone."""
    command = ["git", "rev-parse", "--short=12", "HEAD"]
    root = Path(__file__).parents[1]
    done = subprocess.run(command, cwd=root, capture_output=True, text=True, check=False)
    return done.stdout.strip() or "no commit"


def seed() -> str:
    """The word that decides on what is drawn: the variable's, or the commit, so that a commit always draws the same."""
    return os.environ.get(SEED) or _commit()


def drawn(names: Iterable[str], number: int) -> set[str]:
    """So many of these names, other ones in another commit."""
    listed = sorted(names)
    return set(Random(f"{seed()} {listed[0]}").sample(listed, min(number, len(listed)))) if listed else set()


def due(value: Any, name: str, changed: bool) -> Any:
    """A value for a test that runs in each tier where something that it depends on has changed."""
    return pytest.param(value, id=name, marks=[pytest.mark.due] if changed else [])


def asked_for(request: pytest.FixtureRequest, parameter: str) -> list[Any]:
    """The values of a parameter in the tests of this session that use the fixture which asks."""
    asking = [
        item for item in request.session.items if request.fixturename in getattr(item, "fixturenames", ())
    ]
    params = [getattr(item, "callspec").params for item in asking if hasattr(item, "callspec")]  # noqa: B009
    return [own[parameter] for own in params if parameter in own]


def left_to_all(ids: Sequence[str], due: Iterable[str]) -> set[str]:
    """The ids of the tests that the short tier leaves out.

    Args:
        ids: Of all tests.
        due: Of those that run whatever is drawn.
    """
    left = never_drawn(ids)
    return (left | _not_drawn(SHORT, [one for one in ids if one not in left])) - set(due)


def never_drawn(ids: Sequence[str]) -> set[str]:
    """The ids of the tests that only ``--all`` runs at this commit, whatever has changed."""
    left = {one for one in ids if one.startswith(NIGHTLY)}
    return left | _not_drawn(DRAWS, [one for one in ids if one not in left])


def smoke(ids: Sequence[str]) -> set[str]:
    """The ids of the tests that run whatever has changed."""
    return {one for draw in SMOKE for one in drawn((one for one in ids if draw.has(one)), draw.number)}


def is_smoke(path: str) -> bool:
    """Return whether some test of a file runs whatever has changed."""
    return any(one.startswith(f"{path}::") for draw in SMOKE for one in draw.beginnings)


def too_many(ids: Sequence[str]) -> set[str]:
    """Of the ids of tests that reach a change, those that ``--changed`` leaves to the short tier."""
    return _not_drawn(LONG, ids)


def _not_drawn(draws: Iterable[Draw], ids: Sequence[str]) -> set[str]:
    left = set[str]()
    for draw in draws:
        if draw.whole:
            there = [each for each in draw.beginnings if any(one.startswith(each) for one in ids)]
            others = tuple(set(there) - drawn(there, draw.number))
            left |= {one for one in ids if one.startswith(others)}
            continue
        groups: dict[str, list[str]] = defaultdict(list)
        for one in ids:
            if beginning := next((each for each in draw.beginnings if one.startswith(each)), ""):
                rest = one.removeprefix(beginning)
                groups[rest.partition(draw.group)[0] if draw.group else ""].append(one)
        for group in groups.values():
            left |= set(group) - drawn(group, draw.number)
    return left
