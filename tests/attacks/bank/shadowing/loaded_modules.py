# family = "shadowing"
# tries = "Modules that are loaded already are replaced: rclpy, std_msgs, autograder.notebook, socket, the judge's types; importlib is told where to find false ones."
# could_earn = "All points, where check is imported again."
# undefended = "Only the student's own kernel is changed by it."

# %% extra
import sys
import types

false = types.ModuleType("false")
false.check = lambda *_: 10.0
for name in ("autograder.notebook", "autograder.notebook.checking.check", "autograder.verdict", "rclpy", "std_msgs.msg"):
    sys.modules[name] = false


class Finder:
    @staticmethod
    def find_spec(name, path=None, target=None):
        if name.startswith("autograder"):
            sys.modules[name] = false
        return None


sys.meta_path.insert(0, Finder)
check = false.check
