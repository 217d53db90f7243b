# family = "forging"
# tries = "The shell's run_cell_async is replaced: a check cell is not run, and its result is said to be full marks."
# could_earn = "All points, where a cell's value is the grade."
# undefended = "In stock nbgrader 0.9.5 it earned full marks."

# %% extra
shell = get_ipython()
usual = shell.run_cell_async


async def run_cell_async(raw_cell, *args, **kwargs):
    return await usual("10.0" if "check(" in raw_cell else raw_cell, *args, **{**kwargs, "transformed_cell": None})


shell.run_cell_async = run_cell_async
