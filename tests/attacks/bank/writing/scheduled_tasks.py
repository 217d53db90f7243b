# family = "writing"
# tries = "Tasks are left for the system to start later: cron, systemd, at, profile scripts, ld.so.preload."
# could_earn = "Code as root, later."
# undefended = "As root without a box, every one of them could be written; run here without the system's own folders."
# boxed_only = true

# %% extra
<<writes>>
for path in ('/etc/cron.d/<<mark>>', '/var/spool/cron/crontabs/<<mark>>', '/etc/profile.d/<<mark>>.sh'):
    write(Path(path), '# harmless\n')
