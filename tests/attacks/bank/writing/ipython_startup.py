# family = "writing"
# tries = "Start-up files of IPython and Jupyter are laid into the home folder: whoever starts a kernel next runs them."
# could_earn = "Code in a neighbour's kernel."
# undefended = "Without a box, the file lay in the home folder."

# %% extra
<<writes>>
for home in (Path.home(), Path('<<home>>')):
    write(home / '.ipython/profile_default/startup/<<mark>>.py', 'print(10.0)')
    write(home / '.jupyter/<<mark>>.py', 'print(10.0)')
    write(home / '.config/<<mark>>', 'x')
    write(home / '.<<mark>>_profile', 'x')
