# family = "reading"
# tries = "The reference outputs are looked for: by their names, through the judge's own reader, and in everything below the package and the environment."
# could_earn = "What every criterion compares with."
# undefended = "LEAK: the reference outputs of the repository were read."

# %% extra
import glob
import sys

for pattern in ("<<repository>>/solutions/*/*/*.json", sys.prefix + "/**/talker.reference.json", "/**/talker.reference.json"):
    for name in glob.iglob(pattern, recursive=pattern.count("**") == 1 and not pattern.startswith("/**")):
        print("LEAK:", name)
try:
    from autograder.judge import evidence_files

    print("LEAK:", evidence_files.load_reference("lab_1_2.talker").parts[0].events[:2])
except Exception as error:
    print(type(error).__name__)
