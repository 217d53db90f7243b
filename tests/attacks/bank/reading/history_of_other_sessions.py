# family = "reading"
# tries = "The history of IPython is searched for what other kernels have run: through the history's own functions, and in each database of a profile that can be seen."
# could_earn = "The cells of other submissions, and what the instructor typed while trying the master."
# undefended = "LEAK: an input of another session, from the profile in the home folder."

# %% extra
import glob
import sqlite3

history = get_ipython().history_manager
texts = [(session, text) for session, _, text in history.get_tail(10_000) if session != history.session_number]
for pattern in ("<<home>>/.ipython/**/*.sqlite*", "/root/**/history.sqlite", "/home/*/.ipython/**/*.sqlite*", "/tmp/**/history.sqlite"):
    for path in glob.glob(pattern, recursive=True, include_hidden=True):
        try:
            texts += sqlite3.connect(f"file:{path}?immutable=1", uri=True).execute("SELECT session, source FROM history").fetchall()
        except sqlite3.Error:
            pass
for session, text in texts:
    if text not in history.input_hist_raw:
        print("LEAK:", session, text[:150])
