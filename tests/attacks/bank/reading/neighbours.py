# family = "reading"
# tries = "The submissions of the neighbours are read where they lie, and where their notebooks run."
# could_earn = "A neighbour's work to hand in as one's own."
# undefended = "LEAK: in stock nbgrader 0.9.5 and without a box, the files of the class could be read."

# %% extra
import glob

for pattern in ("<<class>>/submitted/*/*/*.ipynb", "<<class>>/autograded/*/*/*.ipynb", "/tmp/autograder-*/*/*/*/work/*"):
    for name in glob.glob(pattern):
        try:
            text = open(name).read()
        except OSError:
            continue
        print("LEAK:", name, text[text.find("canary-of"):][:40])
