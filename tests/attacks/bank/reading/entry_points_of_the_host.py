# family = "reading"
# assignment = "lab_1_1"
# boxed_only = true
# tries = "Among what its build makes is a list of entry points that is a link, by way of another link, to a file of the grader's home folder."
# could_earn = "Lines of files that only the grader may read, in the evidence and on the card."
# undefended = "Its lines of the form of an entry point were taken for the package's."

# %% solution files
<<silent_package>>
<<leads_out>>
(folder / "setup.py").write_text((folder / "setup.py").read_text().replace("simple_node =", "another_name ="))
leads_out("<<home>>/entry_points.txt")
