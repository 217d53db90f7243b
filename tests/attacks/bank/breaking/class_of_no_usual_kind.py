# family = "breaking"
# tries = "The subject is a class whose own class ends the process that asks for its name, its module, its source or its instances."
# could_earn = "A judge that ends over it, so that the zero becomes no grade."
# undefended = "Zero points, and a sentence about what was given to check."

# %% solution TalkerNode
class Guarded(type(Node)):
    def __getattribute__(cls, name):
        if name in ("__name__", "__qualname__", "__module__", "__doc__", "__mro__", "__wrapped__", "__signature__"):
            raise SystemExit(name)
        return super().__getattribute__(name)

    def __instancecheck__(cls, one): raise SystemExit("isinstance")

    def __subclasscheck__(cls, one): raise SystemExit("issubclass")

    def __call__(cls, *_): raise SystemExit("call")

    def __repr__(cls): raise SystemExit("repr")

    def __eq__(cls, other): raise SystemExit("equal")

    def __hash__(cls): raise SystemExit("hash")


class TalkerNode(Node, metaclass=Guarded):
    pass
