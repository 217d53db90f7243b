# family = "breaking"
# tries = "Folders are nested three thousand deep, without rights and with names that no text can hold, so that nobody can remove them."
# could_earn = "A grader that stumbles while it tidies up, and a disk that fills from run to run."
# undefended = "They are removed."

# %% extra
import os

home = os.getcwd()
os.mkdir(b"\xff\xfe\n")
for _ in range(3000):
    os.mkdir("d" * 100)
    os.chdir("d" * 100)
os.mkdir("locked", 0)
os.chdir(home)
