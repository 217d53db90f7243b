# family = "forging"
# tries = "An input transformer of IPython turns the text of every check cell into the number of full marks."
# could_earn = "All points, where a cell's value is the grade."
# undefended = "In stock nbgrader 0.9.5 it earned full marks."

# %% extra
def full_marks(lines):
    return ["10.0\n"] if "check(" in "".join(lines) else lines

get_ipython().input_transformers_post.append(full_marks)
