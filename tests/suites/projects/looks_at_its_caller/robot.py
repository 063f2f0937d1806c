import inspect
import sys
import warnings


class Arm:
    def __init__(self):
        self.x, self.log = 0.0, []

    def move_by(self, dx):
        caller = sys._getframe(1)
        line = caller.f_lineno - caller.f_code.co_firstlineno
        self.log.append((caller.f_code.co_name, caller.f_globals["__name__"], caller.f_lineno, line))
        if abs(dx) > 1:
            warnings.warn("a long way", stacklevel=2)
        self.x += dx

    def home(self):
        if inspect.stack()[1].function != "tour":
            raise PermissionError("only a tour may end at home")
        self.x = 0.0

    def position(self):
        if sys._getframe(1).f_globals["__name__"] != "mission":
            raise PermissionError("nobody else may ask")
        return self.x
