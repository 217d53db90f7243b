"""What stands in one cell of a made class: the task, its solution, and what students make of it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import nbformat

if TYPE_CHECKING:
    from tiny_class import TinyClass

STUB = """\
class Talker(Node):
    def __init__(self):
        super().__init__("talker")
        # TODO: publish on /chatter.
"""
SOLUTION = """\
class Talker(Node):
    def __init__(self):
        super().__init__("talker")
        self.publisher_ = self.create_publisher(String, "/chatter", 10)
        self.timer_ = self.create_timer(0.5, self.on_timer)
        self.count_ = 0

    def on_timer(self):
        message = String()
        message.data = f"Hello, world! {self.count_}"
        self.publisher_.publish(message)
        self.get_logger().info(f'Publishing: "{message.data}"')
        self.count_ += 1
"""
NEAR = """\
class Talker(Node):
    \"\"\"Says hello.\"\"\"

    def __init__(self):
        super().__init__("talker")
        self.pub = self.create_publisher(String, "/chatter", 10)
        self.timer = self.create_timer(0.5, self.tick)
        self.i = 0

    def tick(self):
        msg = String()
        msg.data = f"Hello, world! {self.i}"
        self.pub.publish(msg)
        self.get_logger().info("Publishing: " + msg.data)
        self.i += 1
"""
ALSO_NEAR = """\
class Talker(Node):
    def __init__(self):
        super().__init__("talker")
        self.number = 0
        self.chatter = self.create_publisher(String, "/chatter", 10)
        self.every = self.create_timer(0.5, self.say_hello)

    def say_hello(self):
        text = "Hello, world! " + str(self.number)  # the text
        self.chatter.publish(String(data=text))
        self.get_logger().info(text)
        self.number = self.number + 1
"""
OF_ONES_OWN = """\
class Talker(Node):
    def __init__(self):
        super().__init__("talker")
        self.words = itertools.cycle(["Hello", "Bonjour", "Hola"])
        self.out = self.create_publisher(String, "/chatter", 10)
        self.done = threading.Event()
        self.worker = threading.Thread(target=self.work, daemon=True)
        self.worker.start()

    def work(self):
        begun = time.monotonic()
        for number, word in enumerate(self.words):
            if self.done.wait(max(0.0, begun + 0.5 * number - time.monotonic())):
                return
            self.out.publish(String(data=f"{word}, world! {number}"))

    def destroy_node(self):
        self.done.set()
        self.worker.join(timeout=2.0)
        super().destroy_node()
"""
COPIED = """\
class Talker(Node):
    # my own work <script>alert(1)</script>
    def __init__(self):
        super().__init__("talker")
        self.greetings = itertools.cycle(["Hi", "Salut", "Hola"])
        self.channel = self.create_publisher(String, "/chatter", 10)
        self.stopped = threading.Event()
        self.runner = threading.Thread(target=self.loop_of_mine, daemon=True)
        self.runner.start()


    def destroy_node(self):
        self.stopped.set()
        self.runner.join(timeout=2.0)
        print("the end")
        super().destroy_node()

    def loop_of_mine(self):
        t0 = time.monotonic()
        for k, greeting in enumerate(self.greetings):
            if self.stopped.wait(max(0.0, t0 + 0.5 * k - time.monotonic())):
                return
            self.channel.publish(String(data=f"{greeting}, world! {k}"))
"""
"""The same with other names, texts and comments, a line put in, and its methods in another order."""


def write_task(tiny: TinyClass) -> None:
    """Give the first cell of a tiny class a task worth copying."""
    for folder, text in (("source", f"### BEGIN SOLUTION\n{SOLUTION}### END SOLUTION"), ("release", STUB)):
        path = tiny.path / folder / "lab_1_2" / "lab_1_2.ipynb"
        notebook = nbformat.read(path, as_version=4)
        cell_of(notebook)["source"] = text
        path.write_text(nbformat.writes(notebook), encoding="utf-8")


def hand_in(tiny: TinyClass, student: str, text: str, *own_cells: str) -> None:
    """Have a student hand in an answer to it, and perhaps cells of their own."""
    notebook = tiny.released()
    cell_of(notebook)["source"] = text
    notebook.cells += [nbformat.v4.new_code_cell(source) for source in own_cells]
    tiny.hand_in(student, notebook)


def cell_of(notebook: nbformat.NotebookNode) -> nbformat.NotebookNode:
    """The cell with the task."""
    return next(
        cell for cell in notebook.cells if cell.metadata.get("nbgrader", {}).get("grade_id") == "Talker"
    )
