"""What the short tier takes in turn: of each family of tests some, which the commit draws."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Draw:
    """Tests of which some run, of those that no line above leaves to ``--all``.

    Attributes:
        tests: The beginning of their ids, or several.
        number: How many of each group.
        group: What ends the name of a group in an id; all are one group where empty.
        whole: Whether all tests with one beginning are drawn together, because they share what takes long to make.
    """

    tests: str | tuple[str, ...]
    number: int
    group: str = ""
    whole: bool = False

    @property
    def beginnings(self) -> tuple[str, ...]:
        """The beginnings of their ids."""
        return (self.tests,) if isinstance(self.tests, str) else self.tests

    def has(self, test: str) -> bool:
        """Whether the test with this id is one of them."""
        return test.startswith(self.beginnings)


GRAPH = tuple(
    f"tests/environment/ros2_command/test_graph.py::test_{name}"
    for name in ("what", "ctrl_c_ends", "hz", "bw", "delay", "pub", "call", "parameters", "doctor", "other")
)
"""Verbs of the ros2 command with real nodes: all of them but Ctrl-C, which has to cancel a goal."""
LIVE = "tests/judge/test_bank.py::test_answer_is_judged_right"
SHORT = (
    # Each of the two thousand answers is judged in this tier from what was seen of it, and if its scenario has changed
    # then itself: these show that what is judged itself still comes to what was kept.
    Draw(f"{LIVE}[", 32),
    # Of the families of attacks: eleven take turns. The box, layer by layer, is tested in tests/boxes.
    Draw("tests/attacks/test_attacks.py::test_it_is_defeated[", 5),
    # Exercise by exercise: one that has changed is reached by `--changed`.
    Draw("tests/judge/test_missing_events.py::test_no_exercise_needs_an_event_to_come_to_a_verdict[", 25),
    Draw("tests/appeals/test_appeal_file.py::test_no_file_takes_much_memory[", 2),
    Draw("tests/test_left_behind.py::test_everything_ends_with_the_command[", 1),
    Draw("tests/appeals/test_every_exercise.py::test_an_appeal_file_brings_the_same_verdict_again[", 20),
    Draw("tests/exercises/test_unsolved.py::test_doing_nothing_earns_nothing[", 60),
    Draw("tests/exercises/test_unsolved.py::test_of_a_subject_that_does_nothing", 30),
    Draw("tests/exercises/test_unsolved.py::test_each_criterion_and_mistake_can_look_at_any_evidence[", 30),
    # What JupyterLab shows: each starts a server, kernels and a browser, 25 seconds of a processor.
    Draw(
        tuple(
            f"tests/browser/test_{name}.py::"
            for name in ("first_minutes", "restart", "terminals", "validate", "verdict_in_view")
        ),
        1,
        whole=True,
    ),
    # Whole ways with programs of their own, in turn. Below each is said what of it the short tier always tests.
    Draw(
        (
            # The book. Links between its pages: test_docs.py; what is written of each notebook: test_site_sources.py.
            "tests/authoring/test_site.py::",
            # All but the notebooks of what is handed out: another test of the file.
            "tests/test_handed_out_answers.py::test_no_class_of_a_notebook_answers_an_exercise",
            # The rules of an example: test_exercise_faults.py; what is copied: the other tests of the file.
            "tests/authoring/test_new_exercise.py::test_a_new_exercise_works",
            "tests/authoring/test_new_exercise.py::test_an_example_is_in_step",
            # What is in the wheel: the other tests of the file.
            "tests/test_wheel.py::test_an_interface_of_ones_own_builds_itself",
            # Ended at any write, within the process: test_where_it_goes.py.
            "tests/grading/day/test_killed_at_random.py::test_collect_is_ended_and_goes_on",
        ),
        1,
        whole=True,
    ),
    # Builds by colcon, beside the first, the failing one and the one of a changed text, which always run.
    Draw(
        (
            "tests/workspaces/builds/test_colcon.py::test_of_interfaces_all_is_built_that_a_node_needs",
            "tests/workspaces/builds/test_colcon.py::test_what_setuptools_refuses",
            "tests/workspaces/builds/test_plain_packages.py::test_the_files_of_each_package_of_the_bank",
            "tests/workspaces/builds/test_plain_packages.py::test_beside_another_package",
            "tests/workspaces/builds/test_students_builds.py::test_the_sources_are_built",
            "tests/workspaces/builds/test_students_builds.py::test_a_change_since_then",
            "tests/environment/ros2_command/test_pkg_create.py::test_colcon_builds_what_was_created",
            "tests/workspaces/test_graded_notebooks.py::test_the_master_gets_full_marks",
        ),
        2,
        whole=True,
    ),
    # A class graded by a command or by nbgrader, beside the commands of test_guide.py and the sample class.
    Draw(
        (
            "tests/grading/test_hostile_folder.py::test_nothing_of_the_current_folder_runs_while_a_class_is_graded",
            "tests/grading/test_own_drawings.py::test_what_knows_the_hand_out_by_heart_has_no_points",
            "tests/grading/classes/test_class_lock.py::test_two_batches_started_at_once",
            "tests/grading/classes/test_class_file.py::test_a_workspace_that_is_sourced",
            "tests/grading/test_earlier_class.py::",
            "tests/grading/day/test_own_assignments.py::test_an_own_assignment",
            "tests/grading/day/test_own_assignments.py::test_tests_stand_beside",
            "tests/masters/test_equals_nbgrader.py::test_the_formgrader_gives_the_same_bytes",
        ),
        2,
        whole=True,
    ),
    # Pictures that nodes move in a kernel of its own: what is drawn is tested in tests/robot and tests/notebook.
    Draw(("tests/notebook/test_live_robot.py::", "tests/notebook/observing/test_live_graph.py::"), 2),
    Draw("tests/notebook/nodes/test_ros_session.py::test_what_a_program_that_starts_ros_prints[", 3),
    Draw("tests/notebook/nodes/test_kernel_exit.py::test_a_process_ends_cleanly[", 4),
    Draw("tests/authoring/test_executing.py::", 3),
    Draw("tests/judge/bench/test_hangs.py::test_a_silent_subject_is_asked_at_the_end_of_its_run[", 1),
    Draw("tests/judge/test_misnamed.py::test_the_other_criteria_are_judged_under_the_subjects_name[", 1),
    Draw(
        tuple(
            f"tests/authoring/mutants/test_survey.py::test_a_{name}"
            for name in ("mutant", "row_acc", "row_that")
        ),
        1,
    ),
    Draw("tests/authoring/mutants/test_trials.py::test_each_solution_is_on_paper", 8),
    Draw("tests/authoring/mutants/test_trials.py::test_a_program_that_does_not_work", 2),
    # Commands of a terminal, each of which starts a Python that imports ROS.
    Draw("tests/test_cli.py::test_bad_input_is_named_and_ends_with_2[", 2),
    Draw(
        tuple(
            f"tests/test_cli.py::test_{name}"
            for name in ("what_a_box", "json_is", "the_same_seed", "a_students_program", "a_profile_of")
        ),
        2,
    ),
    Draw("tests/student/test_handout.py::test_it_checks_a_program[", 1),
    Draw(
        (
            "tests/boxes/test_endings.py::test_fork_servers_of_which_one_cannot_start",
            "tests/boxes/test_endings.py::test_the_fork_server_of_programs_starts",
            "tests/boxes/test_endings.py::test_without_boxes_no_fork_server_of_programs_starts",
        ),
        1,
    ),
    Draw("tests/boxes/test_limits.py::test_a_judge_has_a_limit_of_memory[", 1),
    Draw("tests/kit/test_mission_worlds.py::", 13),
    # Cases, or seeds, that all take the same way.
    Draw("tests/grading/collecting/test_collect_cases.py::test_collect[", 90),
    Draw("tests/grading/collecting/test_forged_names.py::test_no_name_that_somebody_chooses", 12),
    Draw("tests/grading/collecting/test_where_it_goes.py::test_whatever_is_collected_in_any_order", 1),
    Draw("tests/grading/collecting/test_cells_of_two_labs.py::test_a_notebook_with_the_cells_of_two_labs", 3),
    Draw("tests/grading/collecting/test_limits_of_unpacking.py::test_what_a_desk_writes_is_not_believed[", 3),
    Draw("tests/grading/new_classes/test_changing_students.py::test_wherever_it_is_killed", 5),
    Draw("tests/grading/reporting/test_filled_lists.py::test_what_an_export_changes_in_a_list[", 10),
    Draw("tests/environment/ros2_command/test_launch_processes.py::test_what_a_launch_says[", 7),
    Draw("tests/authoring/mutants/test_engine.py::test_an_operator_makes_its_mistake[", 10),
    Draw("tests/judge/test_hostile_subjects.py::test_no_subject_ends_its_judge[", 5),
    Draw(GRAPH, 2),
    Draw("tests/masters/test_programs.py::test_the_program_earns_full_marks[", 1),
    Draw("tests/grading/new_classes/test_sample_class.py::test_every_sample_earns_what_it_must[", 2),
)
"""Of what is left, the short tier runs no more than so many; ``--changed`` takes each that reaches a change."""
