class Arm:
    def __init__(self, port="/dev/ttyUSB0"):
        self.line = open(port, "wb", buffering=0)  # no test has one

    def move(self, x, speed=1.0):
        self.line.write(f"M {x} {speed}\n".encode())

    def light(self, on):
        self.line.write(b"L 1\n" if on else b"L 0\n")

    async def place(self, x):
        self.line.write(f"P {x}\n".encode())
