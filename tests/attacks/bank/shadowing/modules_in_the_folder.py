# family = "shadowing"
# tries = "Modules named rclpy, autograder, std_msgs and json are written into the working folder, from where Python imports first; they give full marks."
# could_earn = "All points, where check comes from there."
# undefended = "The student's own kernel may import what it likes; the judge does not run in that folder."

# %% extra
from pathlib import Path

for name in ("rclpy.py", "autograder.py", "json.py", "random.py", "sitecustomize.py", "usercustomize.py", "msgspec.py"):
    Path(name).write_text("def check(*_): return 10.0\ndef loads(*_): return {'score': 10.0}\n")
Path("std_msgs/msg").mkdir(parents=True)
Path("std_msgs/__init__.py").write_text("")
Path("std_msgs/msg/__init__.py").write_text("class String: data = 'Hello, world! 0'\n")
Path("autograder").mkdir()
Path("autograder/__init__.py").write_text("")
Path("autograder/notebook.py").write_text("def check(*_): return 10.0\n")
