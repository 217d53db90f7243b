# family = "breaking"
# tries = "Output without end, as fast as it goes, on both streams."
# could_earn = "A grader without memory, feedback of gigabytes."
# undefended = "The output is cut, the cell stopped at its limit."

# %% extra
import sys

while True:
    print("x" * 1000)
    print("y" * 1000, file=sys.stderr)
