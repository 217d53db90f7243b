# family = "breaking"
# tries = "Cells print one color code of 199,000 parameters, and a color code with every attribute for each letter."
# could_earn = "A grader whose own process makes this student's page for minutes, and a page that no browser opens."
# undefended = "Two seconds for each code of the first kind, 20 s for a notebook; and a page of 40 MB for the second."

# %% extra
CODE = "\x1b[" + ";" * 199_000 + "mx"
print(CODE)

# %% extra
display({"text/plain": CODE}, raw=True)

# %% extra
print(*CODE, sep="", flush=True)

# %% extra
COLOURFUL = "\x1b[1;4;7;38;2;111;222;133;48;2;144;155;166m" + "x\x1b[1m" * 39_000
print(COLOURFUL)

# %% extra
raise ValueError(COLOURFUL)
