# family = "breaking"
# tries = "Every open file of the kernel is closed under its feet, its sockets among them."
# could_earn = "A grader that waits for an answer for ever."
# undefended = "The kernel died or fell silent; zero points, with the reason."

# %% extra
import os

os.closerange(0, 4096)
