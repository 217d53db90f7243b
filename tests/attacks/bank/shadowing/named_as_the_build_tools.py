# family = "shadowing"
# assignment = "lab_1_1"
# tries = "The grader is asked to build the package with modules beside setup.py that are called as setuptools and as what Python loads at its start, and that build the right program in its place; by then they are removed, and the plain package is checked."
# could_earn = "Full marks for a program that was never handed in, also for everybody who hands in the same text."
# earned = { "lab_1_1.hello" = 3 }
# at_most = true
# undefended = "Ten points where the modules are still there at the check: it is the key alone that tells the builds apart."

# %% solution files
<<silent_package>>
<<right_program>>
<<poisoned_build>>
<<asks_for_a_build>>
modules = [folder / f"{name}.py" for name in ("setuptools", "sitecustomize", "usercustomize")]
for module in modules:
    module.write_text(IN_PLACE_OF_SETUPTOOLS.replace("PROGRAM", repr(RIGHT_PROGRAM)) if module == modules[0] else "import setuptools\n")
sources = [*collect_workspace(Path("ros2_ws"))]
for module in modules:
    module.unlink()
ask(sources)
