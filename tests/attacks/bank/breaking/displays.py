# family = "breaking"
# tries = "Fifty thousand displays that are updated again and again, clear_output with wait, and pictures of a megabyte that are none."
# could_earn = "A grader without memory or time."
# undefended = "Outputs are counted and cut."

# %% extra
from IPython.display import clear_output, display, update_display

for number in range(2000):
    display({"text/plain": "x"}, raw=True, display_id=f"d{number}")
for number in range(2000):
    update_display({"text/plain": "y" * 100}, raw=True, display_id=f"d{number}")
for _ in range(30):
    display({"image/png": "A" * 1_000_000, "text/html": "<b>" * 100_000}, raw=True)
clear_output(wait=True)
