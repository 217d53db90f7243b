# family = "forging"
# tries = "The subject is an object that equals everything, has every attribute and is an instance of everything."
# could_earn = "Full marks wherever it is compared with what was expected; it did in stock nbgrader 0.9.5."
# undefended = "It never leaves the kernel: the judge compares what it saw on the wire."

# %% extra
class EverythingMeta(type):
    def __eq__(cls, other): return True
    def __hash__(cls): return 0
    def __instancecheck__(cls, other): return True
    def __subclasscheck__(cls, other): return True
    def __getattr__(cls, name): return cls


class Everything(metaclass=EverythingMeta):
    def __new__(cls, *args, **kwargs): return object.__new__(cls)
    def __init__(self, *args, **kwargs): pass
    def __eq__(self, other): return True
    def __hash__(self): return 0
    def __getattr__(self, name): return Everything()
    def __call__(self, *args, **kwargs): return Everything()
    def __contains__(self, other): return True
    def __iter__(self): return iter(())
    def __float__(self): return 10.0
    def __repr__(self): return "10.0"

# %% solution TalkerNode
TalkerNode = Everything

# %% solution ListenerNode
ListenerNode = Everything()
