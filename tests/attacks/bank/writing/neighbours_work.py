# family = "writing"
# tries = "A neighbour's submission is replaced by an empty one, another one's is removed."
# could_earn = "A better place in the class."
# undefended = "Without a box, the file was replaced."

# %% extra
<<writes>>
write(Path('<<class>>/submitted/honest_ada/lab_1_2/lab_1_2.ipynb'), '{}')
write(Path('<<class>>/submitted/honest_ben/<<mark>>'), 'x')
