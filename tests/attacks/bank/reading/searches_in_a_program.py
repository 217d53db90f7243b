# family = "reading"
# assignment = "lab_1_1"
# earned = { "lab_1_1.hello" = 3 }
# at_most = true
# tries = "The program that the grader starts from a workspace searches as the kernel does, and prints what it has found."
# could_earn = "As in the kernel; the card and the evidence have what a program prints."
# undefended = "LEAK: as in the kernel."
# says = "SEARCHED by searches_in_a_program: "

# %% solution files
<<silent_package>>
<<searches>>
(folder / "my_robot_pkg/simple_node.py").write_text(SEARCHES + """

def main():
    for line in search('searches_in_a_program'):
        print(line, flush=True)
""")
