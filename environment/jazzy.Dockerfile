# The course on the official image of ROS 2 Jazzy, for computers that the wheels do not run on: Windows and macOS with
# Docker Desktop, and Linux on 64-bit ARM. From the root of the clone, or of what students were handed:
#
#   docker build -f environment/jazzy.Dockerfile -t ros2-course .
#   docker run --rm -it -p 8888:8888 --shm-size=512m ros2-course
#
# Then open the address that JupyterLab prints. Notebooks live in the container: with a folder of your own for them,
# or in an editor, use .devcontainer/devcontainer.json, which is made from the first stage.
# Fast DDS moves messages through shared memory: without --shm-size there are 64 MB of it.
FROM ros:jazzy-ros-base AS tools

# What `./course setup` would install by itself as root; here it runs as the image's ordinary user.
RUN apt-get update \
    && apt-get install -y --no-install-recommends \
        bubblewrap ca-certificates g++ gcc libc6-dev python3 python3-dev python3-venv \
    && rm -rf /var/lib/apt/lists/*

FROM tools

COPY --chown=ubuntu . /home/ubuntu/course
USER ubuntu
WORKDIR /home/ubuntu/course
# The set-up finds the sourced ROS and remembers it; afterwards nothing has to be sourced.
SHELL ["/bin/bash", "-c"]
RUN . /opt/ros/jazzy/setup.bash && ./course setup

EXPOSE 8888
CMD ["./course", "lab", "--ip=0.0.0.0", "--no-browser"]
