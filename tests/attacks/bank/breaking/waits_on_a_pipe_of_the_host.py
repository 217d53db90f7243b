# family = "breaking"
# assignment = "lab_1_1"
# boxed_only = true
# tries = "Among what its build makes is a list of entry points that is a link, by way of another link, to a named pipe on the grader's machine."
# could_earn = "A batch that never ends: whoever opens a pipe to read waits until somebody writes."
# undefended = "The worker waited on the pipe, outside of every box, and went on waiting after the batch was gone."

# %% solution files
<<silent_package>>
<<leads_out>>
leads_out("<<home>>/pipe")
