# family = "guessing"
# assignment = "lab_1_1"
# earned = { "lab_1_1.hello" = 3 }
# at_most = true
# boxed_only = true
# tries = "setup.py leaves in install what no build makes: a pipe, a socket, links that lead out, to each other and to a large file hundreds of times; and modules that the process that packs it would import."
# could_earn = "A file of the grader's machine in the build, a grader that waits for a pipe, or code in the process that packs."

# %% solution files
<<silent_package>>
<<asks_for_a_build>>
SETUP = (folder / "setup.py").read_text()
ODD = """
import os, socket
install = "/home/student/ros2_ws/install"
os.makedirs(install, exist_ok=True)
if not os.path.lexists("/tmp/once"):  # setup.py runs several times in a build
    open("/tmp/once", "w").close()
"""


def leave(*lines):
    (folder / "setup.py").write_text(SETUP + ODD + "".join(f"    {line}\n" for line in lines))
    ask([*collect_workspace(Path("ros2_ws"))])

# %% behind files
# Each of these cells is put in front of those that come before it in this file, so this one runs last.
leave("os.symlink('../../../../../../etc/passwd', install + '/l')")
(folder / "setup.py").write_text(SETUP)

# %% behind files
leave("os.symlink('b', install + '/a')", "os.symlink('a', install + '/b')")

# %% behind files
leave("open(install + '/end', 'wb').write(bytes(20_000_000))", "for n in range(300): os.symlink('end', f'{install}/c{n}')")

# %% behind files
leave("os.mkfifo(install + '/p')", "socket.socket(socket.AF_UNIX).bind(install + '/s')")

# %% behind files
leave(
    "site = os.path.expanduser('~/.local/lib/python3.11/site-packages')",
    "os.makedirs(site)",
    "for n in ('usercustomize', 'sitecustomize'): open(f'{site}/{n}.py', 'w').write('import os; os._exit(7)')",
    "for n in ('msgspec', 'enum', 'autograder'): open(os.path.expanduser(f'~/{n}.py'), 'w').write('raise SystemExit(7)')",
)
