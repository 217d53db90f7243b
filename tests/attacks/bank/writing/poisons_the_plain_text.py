# family = "writing"
# assignment = "lab_1_1"
# tries = "The grader is asked to build the right package with a compiled module beside setup.py that builds a program which says nothing; then the right package is checked, as every other student's with this text."
# could_earn = "Nothing, and no point for everybody whose right answer has the same text."
# earned = { "lab_1_1.hello" = 10 }
# undefended = "No point for the right text: it got what was built with the compiled module."

# %% solution files
<<silent_package>>
<<right_program>>
<<poisoned_build>>
(folder / "my_robot_pkg/simple_node.py").write_text(RIGHT_PROGRAM)
poison("import time\n\n\ndef main():\n    time.sleep(3)\n")
