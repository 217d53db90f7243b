# family = "socket"
# tries = "The talker is right. While the listener's check is open, the talker's is asked for again, in the hope that its verdict is entered for the listener."
# could_earn = "The listener's points for the talker's work."
# earned = { "lab_1_2.talker" = 10 }
# undefended = "Refused: the check cell of the listener must ask for the listener."

# %% right TalkerNode

# %% solution ListenerNode
usual = check


def check(exercise, subject):
    return usual("lab_1_2.talker", TalkerNode)


class ListenerNode(Node):
    pass
