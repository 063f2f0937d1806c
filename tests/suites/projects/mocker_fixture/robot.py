class Arm:
    """An arm on a serial line."""

    def __init__(self, port="/dev/ttyUSB0"):
        self.line = open(port, "wb", buffering=0)  # no test has one

    def move_by(self, dx, speed=0.1):
        self.line.write(f"M {dx} {speed}\n".encode())

    def position(self):
        self.line.write(b"?\n")
        return float(self.line.readline())

    def grip(self, closed):
        self.line.write(b"G 1\n" if closed else b"G 0\n")
