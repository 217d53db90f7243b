# family = "reading"
# assignment = "lab_1_1"
# tries = "The setup.py of a package searches as the kernel does, while the grader builds it, and ends the build with what it has found."
# could_earn = "As in the kernel; the card shows the line of a failed build."
# undefended = "LEAK: as in the kernel."
# says = "SEARCHED by searches_in_a_build: "

# %% solution files
<<silent_package>>
<<searches>>
ends = "\nraise RuntimeError(' '.join(search('searches_in_a_build')))\n"
(folder / "setup.py").write_text(SEARCHES + ends)
