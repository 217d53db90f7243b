# family = "forging"
# tries = "The kernel's replies carry payloads that replace the text of the next cell (set_next_input), as a front end would obey."
# could_earn = "A check cell whose text is 10.0."
# undefended = "Payloads are not read."

# %% extra
for replace in (True, False):
    get_ipython().set_next_input("10.0", replace=replace)
get_ipython().payload_manager.write_payload({"source": "edit_magic", "filename": "/dev/null", "text": "10.0"})
