# family = "writing"
# tries = "Finished builds are put into the cache, so that a neighbour's workspace of the same sources gets the attacker's programs."
# could_earn = "A neighbour's wrong grade, or code in a neighbour's box."
# undefended = "Without a box, the cache of the user could be written."

# %% extra
<<writes>>
import platformdirs

for folder in (platformdirs.user_cache_dir('ros2-course'), platformdirs.user_cache_dir('autograder'), '<<home>>/.cache'):
    write(Path(folder) / '<<mark>>', 'x')
write(Path('/var/tmp/<<mark>>'), 'x')
