# family = "breaking"
# tries = "Memory is taken and written to until there is none."
# could_earn = "A host on which the out-of-memory killer picks its victims."
# boxed_only = true

# %% extra
hoard = []
while True:
    hoard.append(bytearray(b"x") * 50_000_000)
