# family = "guessing"
# assignment = "lab_1_1"
# tries = "The package has a program that says nothing. The grader is asked to build it with a compiled module beside setup.py that builds the right program in its place; then the plain package is checked."
# could_earn = "Full marks for a program that was never handed in, also for everybody who hands in the same text."
# earned = { "lab_1_1.hello" = 3 }
# undefended = "Ten points: compiled files were in the build and not in its key, so the plain package got what was built with them."

# %% solution files
<<silent_package>>
<<right_program>>
<<poisoned_build>>
poison(RIGHT_PROGRAM)
