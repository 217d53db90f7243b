# Right: no phases, but a list of goals that are left; the robot stands while it has none.
import ast
import math
import sys


def command(x, y, heading, goal):
    off = math.remainder(math.atan2(goal[1] - y, goal[0] - x) - heading, math.tau)
    return [0, math.copysign(1, off)] if abs(off) > 0.3 else [1, off]


def decisions(observations):
    home = tuple(observations[0][:2])
    goals, lit, decided = [], False, []
    for x, y, heading, lamp in observations:
        if lamp and not lit:
            lit, goals = True, [lamp, home]
        elif goals and math.hypot(goals[0][0] - x, goals[0][1] - y) < 0.3:
            del goals[0]
        decided.append(command(x, y, heading, goals[0]) if goals else [0, 0])
    return decided


print(decisions(ast.literal_eval(sys.argv[1])))
