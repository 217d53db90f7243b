# family = "breaking"
# tries = "One line of a hundred megabytes, as output, as a return value and as an error."
# could_earn = "A grader without memory, feedback of gigabytes."
# undefended = "A message that is too large is dropped, the connection made anew."

# %% extra
print("x" * 100_000_000)

# %% extra
"y" * 100_000_000

# %% extra
raise ValueError("z" * 100_000_000)
