# family = "writing"
# tries = "Files are left in every folder that other submissions may look into: /tmp, /var/tmp, /dev/shm, /run, the scratch folders of the workers."
# could_earn = "A message or a trap for another submission."
# undefended = "Without a box, the files were there afterwards."

# %% extra
<<writes>>
for folder in ('/tmp', '/var/tmp', '/dev/shm', '/run', '/run/lock', os.getcwd() + '/../..', os.getcwd() + '/../../..'):
    write(Path(folder) / '<<mark>>', 'x')
