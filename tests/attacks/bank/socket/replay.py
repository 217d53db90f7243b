# family = "socket"
# tries = "The words of the talker's honest conversation are recorded and said again in the listener's check, under its name."
# could_earn = "The listener's points for the talker's words."
# earned = { "lab_1_2.talker" = 10 }
# undefended = "The judge asks questions on the wire that no recorded word answers."

# %% extra
<<talks_to_the_judge>>

import autograder.notebook.checking.judge_link as judge_link
from autograder.messages.json_lines import encode

said = []
usual_say = judge_link.JudgeLink.say
judge_link.JudgeLink.say = lambda self, message: (said.append(json.loads(encode(message))), usual_say(self, message))[1]

# %% right TalkerNode

# %% solution ListenerNode
def check(exercise, subject):
    link = connect()
    for words in said:
        rest = {name: value for name, value in words.items() if name != "say"}
        say(link, words["say"], **{**rest, **({"exercise": exercise} if "exercise" in rest else {})})
        time.sleep(0.05)
    return 10.0


class ListenerNode(Node):
    pass
