"""The line of the student's that a traceback is about."""

from __future__ import annotations

from autograder.cards.readable_text import TracebackLine, students_line

OF_A_PROGRAM = """Traceback (most recent call last):
  File "/home/ada/talker.py", line 30, in main
    rclpy.spin(node)
  File "/opt/x/lib/python3.12/site-packages/rclpy/__init__.py", line 226, in spin
    executor.spin_once()
TypeError: tick() takes 0 positional arguments but 1 was given"""


def test_of_a_program_it_is_the_last_line_of_its_own() -> None:
    error = "TypeError: tick() takes 0 positional arguments but 1 was given"
    assert students_line(OF_A_PROGRAM) == TracebackLine("Line 30 of talker.py", "rclpy.spin(node)", error)


def test_a_line_that_spins_is_not_blamed_for_a_callback() -> None:
    task = '  File "/opt/x/lib/python3.12/site-packages/rclpy/task.py", line 239, in __call__\n    self._handler()'
    first, last = OF_A_PROGRAM.rsplit("\n", 1)
    assert students_line(f"{first}\n{task}\n{last}") is None
    own = '  File "/home/ada/talker.py", line 12, in tick\n    self.sey()'
    found = students_line(f"{first}\n{task}\n{own}\n{last}")
    assert found
    assert (found.where, found.quote) == ("Line 12 of talker.py", "self.sey()")


def test_a_file_that_python_cannot_read_has_a_line_without_a_traceback() -> None:
    detail = (
        "  File \"/home/ada/talker.py\", line 14\n    def tick(self)\n          ^\nSyntaxError: expected ':'"
    )
    assert students_line(detail) == TracebackLine(
        "Line 14 of talker.py", "def tick(self)", "SyntaxError: expected ':'"
    )


def test_what_a_build_has_installed_is_the_students_own() -> None:
    file = "/ws/install/my_robot_pkg/lib/python3.12/site-packages/my_robot_pkg/talker.py"
    detail = (
        f'Traceback (most recent call last):\n  File "{file}", line 9, in main\n    tock()\nNameError: tock'
    )
    assert students_line(detail) == TracebackLine("Line 9 of talker.py", "tock()", "NameError: tock")
    assert students_line(detail.replace("/ws/install/my_robot_pkg", "/ws/.venv")) is None


def test_a_line_that_python_does_not_quote_has_no_quote() -> None:
    found = students_line(
        'Traceback (most recent call last):\n  File "<ipython-input-3>", line 2, in f\nKeyError: 1'
    )
    assert found == TracebackLine("Line 2 of your cell", "", "KeyError: 1")


def test_the_script_of_an_entry_point_is_nobodys() -> None:
    script = '  File "/ws/install/my_pkg/lib/my_pkg/talker", line 25, in importlib_load_entry_point\n    return 1\n'
    text = f"Traceback (most recent call last):\n{script}ModuleNotFoundError: No module named 'talker'"
    assert students_line(text) is None


def test_output_that_is_no_traceback_has_no_place() -> None:
    assert students_line("Hello, world! 0\nTerminated") is None
    assert students_line("") is None
    assert students_line("Traceback (most recent call last):") is None


def test_an_error_of_compiled_code_is_told_without_the_arguments_below_it() -> None:
    detail = (
        'Traceback (most recent call last):\n  File "talker.py", line 7, in __init__\n    make("chatter", String)\n'
        "TypeError: resolve(): incompatible function arguments. The following argument types are supported:\n"
        "    1. (name: str) -> str\n\nInvoked with: <class 'String'>, False"
    )
    found = students_line(detail)
    assert found
    assert found.error.startswith("TypeError: resolve(): incompatible function arguments")


def test_the_line_that_the_advice_quotes_is_shown_and_not_a_given_functions() -> None:
    detail = (
        "Traceback (most recent call last):\n"
        '  File "/tmp/ipykernel_1/11.py", line 7, in add_three_ints\n    first = ask(client, node, a, b)\n'
        '  File "/tmp/ipykernel_1/22.py", line 6, in ask\n    future = client.call_async(request)\n'
        "AttributeError: 'Node' object has no attribute 'call_async'\n"
    )
    given, own = (
        students_line(detail),
        students_line(detail, "In `first = ask(client, node, a, b)`, they are swapped."),
    )
    assert given is not None
    assert given.where == "Line 6 of the cell with ask, called in line 7 of the cell with add_three_ints"
    assert own is not None
    assert (own.where, own.quote) == (
        "Line 7 of your cell",
        "first = ask(client, node, a, b)",
    )


def test_of_two_cells_each_is_named_by_its_function() -> None:
    text = (
        "Traceback (most recent call last):\n"
        '  File "/lib/rclpy/task.py", line 9, in __call__\n    self.handler()\n'
        '  File "/tmp/ipykernel_1/11.py", line 6, in act\n    seen = observe(self.scan)\n'
        '  File "/tmp/ipykernel_1/22.py", line 3, in observe\n    ahead = scan.ranges[0]\n'
        "AttributeError: 'NoneType' object has no attribute 'ranges'"
    )
    where = "Line 3 of the cell with observe, called in line 6 of the cell with act"
    error = "AttributeError: 'NoneType' object has no attribute 'ranges'"
    assert students_line(text) == TracebackLine(where, "ahead = scan.ranges[0]", error)
    alone = students_line(text.replace("/22.py", "/11.py"))
    assert alone is not None
    assert alone.where == "Line 3 of your cell"
