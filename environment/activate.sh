# ROS and the tools of the course in this terminal:   . environment/activate.sh   (bash or zsh)
#
# For `python talker.py`, `colcon build` and programs in C++. What is started by .venv/bin/python needs none of this:
# every Python of the environment sets these variables by itself (course_process.py).

# In bash and in zsh the path of the file that is being sourced; zsh's way is no syntax for bash.
if [ -n "${BASH_VERSION:-}" ]; then
    _course_file=${BASH_SOURCE[0]}
elif [ -n "${ZSH_VERSION:-}" ]; then
    eval '_course_file=${(%):-%x}'
else
    _course_file=./environment/activate.sh
fi
_course_root=$(CDPATH='' cd -- "$(dirname -- "$_course_file")/.." && pwd -P)

if [ -x "$_course_root/.venv/bin/python" ]; then
    . "$_course_root/.venv/bin/activate"
    eval "$("$_course_root/.venv/bin/python" -c 'import course_process; print(course_process.export_lines())')"
    # What colcon builds here is what a check would build, so a check can use it.
    export CMAKE_BUILD_TYPE="${CMAKE_BUILD_TYPE:-Release}"
    # Tab completes the words of ros2, the names on the graph and the types of interfaces.
    case "${BASH_VERSION:+bash}$-" in
        bash*i*) eval "$("$_course_root/.venv/bin/register-python-argcomplete" ros2 2>/dev/null)" ;;
    esac
    # `course progress` is ./course progress, from any folder.
    course() {
        "$(dirname -- "$VIRTUAL_ENV")/course" "$@"
    }
else
    echo "The course is not set up here yet. Type: $_course_root/course setup" >&2
fi
unset _course_file _course_root
