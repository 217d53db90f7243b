"""There is one true table: what the gradebook says, whoever gave the points and whatever being late cost."""

from __future__ import annotations

import json
from datetime import datetime, timedelta
from typing import Any

import pytest
from instructor import add_question, book, by_person, due, penalty
from nbgrader.apps.api import NbGraderAPI
from nbgrader.coursedir import CourseDirectory
from tiny_class import LISTENER, TALKER, TinyClass, shown

from autograder.grading.classes.class_directory import ClassDirectory
from autograder.grading.grading_errors import GradingError
from autograder.grading.reporting.grade_report import report_json
from autograder.grading.returning.feedback_pages import FeedbackPages
from autograder.grading.tasks import submission_times
from tests.cases import cases

pytestmark = pytest.mark.usefixtures("fake_engine")

DUE = datetime(2026, 1, 10, 12)
EARLY, LATE = "2026-01-09 12:00:00.000000 UTC", "2026-01-11 12:00:00.000000 UTC"


def nbgraders_total(tiny: TinyClass, student: str) -> float:
    """As nbgrader exports it."""
    with book(tiny) as gradebook:
        submission: Any = gradebook.find_submission("lab_1_2", student)
        return max(0.0, submission.score - (submission.late_submission_penalty or 0.0))


def total(tiny: TinyClass, student: str) -> float:
    return sum(float(row["score"] or 0) for row in tiny.table() if row["student"] == student)


def page(tiny: TinyClass, student: str) -> str:
    return (tiny.path / "feedback" / student / "lab_1_2" / "lab_1_2.html").read_text()


def test_a_due_date_of_formgrader_is_a_time_in_the_zone_of_the_class(tiny: TinyClass) -> None:
    """Due at 23:59 as an instructor in Kolkata types it; Ada hands in half an hour after midnight there."""
    tiny.configure('c.NbGraderAPI.timezone = "Asia/Kolkata"')
    penalty(tiny)
    directory = ClassDirectory(tiny.path)
    formgrader = NbGraderAPI(CourseDirectory(config=directory.config), config=directory.config)
    offset = formgrader.get_assignment("lab_1_2")["duedate_timezone"]
    with book(tiny) as gradebook:
        gradebook.update_or_create_assignment("lab_1_2", duedate=f"2026-01-10T23:59 {offset}")
    for student, at in (("ada", "2026-01-10 19:00:00 UTC"), ("ben", "2026-01-10 18:28:00 UTC")):
        tiny.submit(student, 4, 7).with_name("timestamp.txt").write_text(at)
    report = tiny.grade(feedback=True)
    assert (total(tiny, "ada"), total(tiny, "ben")) == (0, 11)
    assert "due          lab_1_2 2026-01-10 23:59, time zone Asia/Kolkata" in shown(report)
    assert json.loads(report_json(report))["due"] == {"lab_1_2": "2026-01-10T23:59:00+05:30"}
    why = "handed in 2026-01-11 00:30 Asia/Kolkata, due 2026-01-10 23:59 Asia/Kolkata"
    assert next(row for row in tiny.table() if row["exercise"] == "late")["reason"] == why
    assert why in page(tiny, "ada")


def test_a_zone_that_does_not_exist_is_refused(tiny: TinyClass) -> None:
    tiny.configure('c.NbGraderAPI.timezone = "Berlin"')
    with pytest.raises(GradingError, match="that zone does not exist"):
        tiny.grade()


def test_points_by_hand_and_extra_points_are_in_the_table(tiny: TinyClass) -> None:
    tiny.submit("ada", 4, 7)
    tiny.grade(feedback=True)
    by_person(tiny, "ada", TALKER, 6, extra=2)
    report = tiny.grade(feedback=True)
    assert (report.executed, total(tiny, "ada"), nbgraders_total(tiny, "ada")) == (0, 15, 15)
    talker = next(row for row in tiny.table() if row["exercise"] == "lab_1_2.talker")
    assert [talker[name] for name in ("score", "judge", "by_hand", "extra", "state")] == [
        "8",
        "4",
        "6",
        "2",
        "failed",
    ]
    assert "15/20" in shown(report)
    assert "8/10*" in shown(report)
    assert "Score: 15.0 / 20.0" in page(tiny, "ada")


def test_a_later_submission_keeps_the_points_by_hand_and_waits_for_a_person(tiny: TinyClass) -> None:
    tiny.submit("ada", 4, 7)
    tiny.grade()
    by_person(tiny, "ada", TALKER, 6)
    tiny.submit("ada", 9, 7)
    report = tiny.grade()
    assert total(tiny, "ada") == nbgraders_total(tiny, "ada") == 13
    assert [row["waits_for_a_person"] for row in tiny.table()] == ["yes", ""]
    assert "6/10?" in shown(report)
    assert "waits for a person (1 in all)" in shown(report)


def test_a_time_that_becomes_known_later_counts_for_an_unchanged_notebook(tiny: TinyClass) -> None:
    penalty(tiny)
    due(tiny, DUE)
    stamp = tiny.submit("ada", 4, 7).with_name("timestamp.txt")
    tiny.grade(feedback=True)
    assert nbgraders_total(tiny, "ada") == 11
    stamp.write_text(LATE)
    report = tiny.grade(feedback=True)
    assert report.executed == 0
    assert nbgraders_total(tiny, "ada") == total(tiny, "ada") == 0
    assert "Score: 0.0 / 20.0" in page(tiny, "ada")
    assert (tiny.path / "autograded" / "ada" / "lab_1_2" / "timestamp.txt").read_text() == LATE
    stamp.write_text(EARLY)
    tiny.grade(feedback=True)
    assert nbgraders_total(tiny, "ada") == total(tiny, "ada") == 11
    assert "Score: 11.0 / 20.0" in page(tiny, "ada")


def test_a_grade_stays_where_the_clock_goes_wrong_afterwards(
    tiny: TinyClass, monkeypatch: pytest.MonkeyPatch
) -> None:
    tiny.submit("ada", 4, 7).with_name("timestamp.txt").write_text(LATE)
    tiny.grade(feedback=True)
    with monkeypatch.context() as patch:
        patch.setattr(submission_times, "_MAX_AHEAD", timedelta(days=-36_500))  # as if it were a century ago
        report = tiny.grade(feedback=True)
    assert (report.executed, report.written, report.problems) == (0, 0, ())
    assert nbgraders_total(tiny, "ada") == 11


def test_a_page_that_cannot_be_made_anew_is_a_problem_until_it_is(
    tiny: TinyClass, monkeypatch: pytest.MonkeyPatch
) -> None:
    tiny.submit("ada", 4, 7)
    tiny.grade(feedback=True)
    by_person(tiny, "ada", TALKER, 6)

    def fail(*_: object) -> None:
        raise PermissionError("the folder is root's")

    with monkeypatch.context() as patch:
        patch.setattr(FeedbackPages, "write", fail)
        for _ in range(2):
            report = tiny.grade(feedback=True)
            assert "feedback for ada/lab_1_2 could not be made" in "".join(report.problems)
            assert "".join(report.problems).count("nbgrader.log") == 1
    assert tiny.grade(feedback=True).problems == ()
    assert "Score: 13.0 / 20.0" in page(tiny, "ada")


def test_a_policy_of_percent_a_day_with_grace_and_cut_off_is_data(tiny: TinyClass) -> None:
    tiny.configure(
        'c.AssignLatePenalties.plugin_class = "autograder.grading.table.late_policy.LatePolicy"',
        *(
            f"c.LatePolicy.{rule}"
            for rule in ("percent_per_day = 10", "grace_minutes = 15", "cut_off_days = 3")
        ),
    )
    due(tiny, DUE)
    hours = {"ada": -1, "ben": 0.25, "eve": 0.251, "jo": 30, "zoe": 80}
    for student, late in hours.items():
        stamp = tiny.submit(student, 10, 10).with_name("timestamp.txt")
        stamp.write_text(f"{DUE + timedelta(hours=late):%Y-%m-%d %H:%M:%S.%f} UTC")
    tiny.grade(feedback=True)
    assert {student: total(tiny, student) for student in hours} == {
        "ada": 20,
        "ben": 20,
        "eve": 18,
        "jo": 16,
        "zoe": 0,
    }
    assert all(nbgraders_total(tiny, student) == total(tiny, student) for student in hours)
    with book(tiny) as gradebook:
        gradebook.grant_extension("lab_1_2", "jo", days=1)
    tiny.grade(feedback=True)
    assert nbgraders_total(tiny, "jo") == total(tiny, "jo") == 18
    assert "Score: 18.0 / 20.0" in page(tiny, "jo")
    head = page(tiny, "jo").partition('<div id="toc">')[2].partition("</div>")[0]
    # Two days of ten percent, and one with the extension: what was taken off, and why.
    assert "−2" in head
    assert "handed in 2026-01-11 18:00 UTC, due 2026-01-11 12:00 UTC" in head
    assert "Being late" not in page(tiny, "ada")


def test_the_dates_and_the_rule_of_a_class_are_in_one_file(tiny: TinyClass) -> None:
    """Jo has an extension of a day, and Kim's section one of two days; Kim is in both of her sections."""
    (tiny.path / "students.csv").write_text(
        "id,section\nada,\njo,Mon\nkim,Mon and Lab\nmia,Lab\nzoe,\n", encoding="utf-8"
    )
    hours = {"ada": 0.2, "jo": 30, "kim": 30, "mia": 80, "zoe": 30}
    for student, late in hours.items():
        stamp = tiny.submit(student, 10, 10).with_name("timestamp.txt")
        stamp.write_text(f"{DUE + timedelta(hours=late):%Y-%m-%d %H:%M:%S.%f} UTC")
    tiny.grade()
    file = tiny.path / "class.toml"
    file.write_text(cases(__file__, "CLASS_FILE"))
    expected = {"ada": 20, "jo": 18, "kim": 20, "mia": 16, "zoe": 16}
    foreseen = {one.student: one.after for one in tiny.grade(dry_run=True).would_change or ()}
    assert foreseen == {"jo": -2, "mia": -4, "zoe": -4}
    for _ in range(2):
        assert tiny.grade().executed == 0
        assert {student: total(tiny, student) for student in hours} == expected
        assert {student: nbgraders_total(tiny, student) for student in hours} == expected
    tiny.submit("ada", 9, 9)
    tiny.grade()
    file.write_text(file.read_text().replace(f'"{DUE:%Y-%m-%d %H:%M}"', '"none"').partition("[extension")[0])
    tiny.grade()
    assert total(tiny, "zoe") == nbgraders_total(tiny, "zoe") == 20


def test_points_by_hand_for_late_work_are_taken_off_too(tiny: TinyClass) -> None:
    penalty(tiny)
    due(tiny, DUE)
    tiny.submit("ada", 4, 7).with_name("timestamp.txt").write_text(LATE)
    tiny.grade()
    by_person(tiny, "ada", TALKER, 10)
    assert nbgraders_total(tiny, "ada") == 6, "nbgrader itself keeps the old deduction"
    tiny.grade()
    assert nbgraders_total(tiny, "ada") == total(tiny, "ada") == 0


def test_a_time_that_cannot_be_is_refused_for_an_unchanged_notebook_too(tiny: TinyClass) -> None:
    stamp = tiny.submit("ada", 4, 7).with_name("timestamp.txt")
    tiny.grade()
    stamp.write_text("1999-01-01 00:00:00.000000 UTC")
    report = tiny.grade()
    assert report.exit_code == 2
    assert total(tiny, "ada") == nbgraders_total(tiny, "ada") == 0
    stamp.write_text(EARLY)
    assert tiny.grade().executed == 0
    assert total(tiny, "ada") == 11


def test_a_remark_beside_the_points_leaves_them_where_they_are(tiny: TinyClass) -> None:
    """To nbgrader, such a question is two cells of one name: one has the points, the other the remark."""
    add_question(tiny)
    tiny.submit("ada", 4, 7)
    tiny.grade(feedback=True)
    by_person(tiny, "ada", "why", 4)
    with book(tiny) as gradebook:
        gradebook.find_comment("why", "lab_1_2", "lab_1_2", "ada").manual_comment = "Well said."
        gradebook.db.commit()
    tiny.grade(feedback=True)
    why = next(row for row in tiny.table() if row["exercise"] == "why")
    assert [why[name] for name in ("score", "max", "state")] == ["4", "5", "by_hand"]
    assert total(tiny, "ada") == nbgraders_total(tiny, "ada") == 15
    assert "Well said." in page(tiny, "ada")


def test_a_folder_that_was_removed_keeps_its_points_in_the_table(tiny: TinyClass) -> None:
    import shutil

    tiny.submit("ada", 4, 7)
    tiny.submit("ben", 1, 1)
    tiny.grade()
    shutil.rmtree(tiny.path / "submitted" / "ada")
    report = tiny.grade()
    assert total(tiny, "ada") == nbgraders_total(tiny, "ada") == 11
    assert any("ada" in notice and "submitted" in notice for notice in report.notices)
    assert report.exit_code == 0


def test_who_is_in_the_gradebook_and_handed_in_nothing_is_blank_in_the_table(tiny: TinyClass) -> None:
    with book(tiny) as gradebook:
        gradebook.add_student("zoe", first_name="Zoë", last_name="Zuse")
    tiny.submit("ada", 4, 7)
    tiny.grade()
    of_zoe = [row for row in tiny.table() if row["student"] == "zoe"]
    assert [(row["score"], row["max"], row["state"], row["name"]) for row in of_zoe] == [
        ("", "10", "not_submitted", "Zoë Zuse")
    ] * 2


def test_excel_reads_the_names_right(tiny: TinyClass) -> None:
    tiny.submit("José")
    tiny.grade()
    data = (tiny.path / "grades.csv").read_bytes()
    assert data.startswith("\ufeffstudent,".encode())
    assert "José" in data.decode()


def test_a_class_in_which_nothing_is_unusual_has_no_marks(tiny: TinyClass) -> None:
    tiny.submit("ada", 4, 7)
    text = shown(tiny.grade())
    assert "*" not in text
    assert "?" not in text
    assert [row["by_hand"] + row["extra"] + row["waits_for_a_person"] for row in tiny.table()] == ["", ""]
    assert tiny.scores("ada") == {TALKER: 4, LISTENER: 7}


def test_the_head_of_a_page_names_the_exercises(tiny: TinyClass) -> None:
    from autograder import exercises

    tiny.submit("ada", 4, 7)
    tiny.grade(feedback=True)
    head = page(tiny, "ada").partition('id="toc"')[2].partition("</table>")[0]
    assert "Test cell" not in head
    for exercise in ("lab_1_2.talker", "lab_1_2.listener"):
        assert exercises.get(exercise).title in head


def test_the_exchange_gets_what_it_needs_to_return_a_page(tiny: TinyClass) -> None:
    path = tiny.submit("ada", 4, 7)
    path.with_name("timestamp.txt").write_text(EARLY)
    path.with_name("submission_secret.txt").write_text("ab12" * 32)
    tiny.submit("eve").with_name("submission_secret.txt").write_text("<script>")
    tiny.grade(feedback=True)
    for step in ("autograded", "feedback"):
        folder = tiny.path / step / "ada" / "lab_1_2"
        assert (folder / "submission_secret.txt").read_text() == "ab12" * 32
        assert (folder / "timestamp.txt").read_text() == EARLY
        assert not (tiny.path / step / "eve" / "lab_1_2" / "submission_secret.txt").exists()
