def _axis():
    at = 0.0
    while True:
        step = yield at
        if step is not None:
            at = round(at + step, 6)


_lift, _turn = _axis(), _axis()
next(_lift), next(_turn)


def height():
    return next(_lift)


class Arm:
    def lift(self, dz):
        _lift.send(dz)

    def turn(self, angle):
        _turn.send(angle)
