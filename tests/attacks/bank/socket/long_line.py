# family = "socket"
# tries = "The first word to the judge is five megabytes without a line break, then JSON nested a hundred thousand times, numbers without end and lone surrogates."
# could_earn = "A judge that breaks down, in the hope that this is a pass, or that the batch ends."
# undefended = "The conversation ends; zero points."

# %% extra
<<talks_to_the_judge>>


def check(exercise, subject):
    for words in (
        b"x" * 5_000_000,
        b"[" * 100_000 + b"\n",
        b'{"say": "check", "exercise": ' + b"9" * 4000 + b"}\n",
        b'{"say": "check", "exercise": "\\ud800", "kind": NaN}\n',
    ):
        link = connect()
        try:
            link.sendall(words)
            link.recv(1000)
        except OSError:
            pass
    return 10.0
