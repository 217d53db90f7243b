# Right: keeps whether it heats.
import ast
import sys


class Thermostat:
    def __init__(self):
        self.is_on = False

    def decide(self, degrees):
        if degrees < 18 or degrees > 21:
            self.is_on = degrees < 18
        return self.is_on


thermostat = Thermostat()
print([thermostat.decide(degrees) for degrees in ast.literal_eval(sys.argv[1])])
