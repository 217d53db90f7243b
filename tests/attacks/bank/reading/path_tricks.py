# family = "reading"
# tries = "Links out of the working folder are laid, in the hope that the grader follows them when it collects, copies or cleans: to the neighbour's notebook, the secret, the home folder."
# could_earn = "Somebody else's files in one's own feedback, or deleted."
# undefended = "The links are removed and nothing behind them is touched."

# %% extra
import os

for number, target in enumerate((
    "<<class>>/submitted/honest_ada/lab_1_2/lab_1_2.ipynb", "<<class>>/.autograder/secret", "<<home>>/.ssh", "/", "<<class>>",
)):
    for name in (f"link_{number}", f"../link_{number}", f"{os.environ['HOME']}/link_{number}", f"lab_1_2_{number}.ipynb"):
        try:
            os.symlink(target, name)
        except OSError:
            pass
os.makedirs("locked/inside", exist_ok=True)
os.symlink("<<home>>", "locked/inside/home")
os.chmod("locked/inside", 0)
os.chmod("locked", 0)
