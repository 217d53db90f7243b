# family = "writing"
# tries = "The notebook that is being graded, its feedback and its grade are written into the working folder and around it, in the hope that they are collected from there."
# could_earn = "A grade of one's own writing."
# undefended = "Nothing is collected from the working folder."

# %% extra
<<writes>>
for folder in (Path.cwd(), Path.cwd().parent, Path('<<class>>/autograded/own_notebook/lab_1_2'), Path('<<class>>/feedback/own_notebook/lab_1_2')):
    write(folder / 'lab_1_2.ipynb', '{"cells": [], "metadata": {"score": 10.0}, "nbformat": 4, "nbformat_minor": 5}')
    write(folder / 'lab_1_2.html', '<h1>Full marks</h1>')
    write(folder / 'verdict.json', '{"score": 10.0}')
