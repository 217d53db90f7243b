# What a terminal of the course's JupyterLab starts with: the user's own settings, then ROS.
if [ -r ~/.bashrc ]; then
    . ~/.bashrc
fi
. "$(dirname -- "${BASH_SOURCE[0]}")/activate.sh"

# Where JupyterLab's own folder has a single chapter, a terminal begins in it, as the notebooks do.
if [ "$PWD" = "${AUTOGRADER_NOTEBOOKS:-}" ]; then
    _course_chapters=([!._]*)
    if [ ${#_course_chapters[@]} -eq 1 ] && [ -d "${_course_chapters[0]}" ]; then
        cd -- "${_course_chapters[0]}"
    fi
    unset _course_chapters
fi
