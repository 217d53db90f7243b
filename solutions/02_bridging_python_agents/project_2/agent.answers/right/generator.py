# Right: a generator that is put aside at each command, so the phase is the line at which it waits.
import ast
import math
import sys


def towards(seen, goal):
    x, y, heading, _ = seen
    off = math.remainder(math.atan2(goal[1] - y, goal[0] - x) - heading, math.tau)
    return (0.0, math.copysign(1.0, off)) if abs(off) > 0.3 else (1.0, off)


def agent(seen):
    home = seen[:2]
    while seen[3] is None:
        seen = yield (0.0, 0.0)
    seen = yield towards(seen, seen[3])
    while math.dist(seen[:2], seen[3]) >= 0.3:
        seen = yield towards(seen, seen[3])
    seen = yield towards(seen, home)
    while math.dist(seen[:2], home) >= 0.3:
        seen = yield towards(seen, home)
    while True:
        yield (0.0, 0.0)


first, *others = ast.literal_eval(sys.argv[1])
finder = agent(first)
print([next(finder), *(finder.send(each) for each in others)])
