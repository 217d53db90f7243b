# What a terminal of the course's JupyterLab starts with: the user's own settings, then ROS.
if [ -r ~/.bashrc ]; then
    . ~/.bashrc
fi
. "$(dirname -- "${BASH_SOURCE[0]}")/activate.sh"
