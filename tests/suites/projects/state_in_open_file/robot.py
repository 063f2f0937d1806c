import tempfile

_record = tempfile.TemporaryFile("w+")


def steps():
    _record.seek(0)
    return [float(line) for line in _record.read().splitlines()]


class Arm:
    def lift(self, dz):
        print(dz, file=_record, flush=True)

    def turn(self, angle):
        print(angle, file=_record, flush=True)
