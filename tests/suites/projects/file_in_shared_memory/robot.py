from pathlib import Path
from zlib import crc32

#: beside the others in memory that all processes share; copies of this project may run side by side
POSITION = Path("/dev/shm", f"corpus_axis_{crc32(str(Path(__file__).resolve().parent).encode()):08x}")


class Axis:
    def __init__(self):
        self.at = 0.0

    def jog(self, mm):
        self.at += mm

    def read(self):
        return self.at
