# family = "reading"
# tries = "The names of the variables that each process was started with are compared with what Python and ROS need, and their values with folders that can be seen."
# could_earn = "What the terminal of the instructor says of other work: tokens, private workspaces, names of folders."
# undefended = "LEAK: in 7042be52 each variable whose name began with ROS_, LC_, RCUTILS_, AMENT_ or FASTDDS_, and all folders of PATH."

# %% extra
import os
import re

USUAL = re.compile(
    "PATH|PWD|LANG|LANGUAGE|TZ|HOME|USER|TMPDIR|TERM|SHLVL|_|VIRTUAL_ENV|LD_LIBRARY_PATH|IPYTHONDIR|JUPYTER_CONFIG_DIR|MPLBACKEND"
    "|(CLICOLOR|FORCE_COLOR|GIT_PAGER|PAGER|KERNEL_LAUNCH_TIMEOUT|JPY_\\w+|PYDEVD_\\w+|(OPENBLAS|OMP|MKL)_NUM_THREADS)(_FORCE)?"
    "|PYTHON(PATH|UTF8|UNBUFFERED|NOUSERSITE|DONTWRITEBYTECODE)|LC_(ALL|CTYPE|COLLATE|MESSAGES|MONETARY|NUMERIC|TIME)|CONDA_PREFIX"
    "|(AMENT|CMAKE|COLCON)_PREFIX_PATH|CMAKE_BUILD_TYPE|BASH_FUNC_command_not_found_handle%%|ROS_(DISTRO|VERSION|PYTHON_VERSION|DOMAIN_ID|LOG_DIR|AUTOMATIC_DISCOVERY_RANGE|LOCALHOST_ONLY"
    "|STATIC_PEERS|PYTHON_CHECK_FIELDS)|RMW_IMPLEMENTATION|FASTDDS_BUILTIN_TRANSPORTS|RCUTILS_(COLORIZED_OUTPUT|CONSOLE_OUTPUT_FORMAT"
    "|LOGGING_BUFFERED_STREAM|LOGGING_USE_STDOUT)|AUTOGRADER_(JUDGE_SOCKET|BUILDS)|_ROS_WHEELS_BOOTSTRAP_COMPLETE"
)
for process in (*filter(str.isdigit, os.listdir("/proc")), "self"):
    try:
        with open(f"/proc/{process}/environ", errors="replace") as file:
            variables = dict(line.split("=", 1) for line in file.read().split("\0") if "=" in line)
    except OSError:
        continue
    if process == "self":
        variables |= os.environ
    for name, value in variables.items():
        if not USUAL.fullmatch(name):
            print("LEAK:", process, name)
        if name.endswith("PATH"):
            for folder in value.split(":"):
                if folder and not folder.startswith(("/usr", "/bin", "/sbin")) and not os.path.exists(folder):
                    print("LEAK:", process, name, folder)
