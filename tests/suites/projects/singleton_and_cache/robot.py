from functools import lru_cache


class Link:
    def __init__(self, log=[]):  # noqa: B006  # the log is shared on purpose
        self.log = log
        self.position = 0.0
        self.offset = 0.0

    def jog(self, dz):
        self.position = round(self.position + dz, 6)
        self.log.append(dz)

    def zero(self):
        self.offset = self.position

    def read(self):
        return round(self.position - self.offset, 6)


@lru_cache
def connect():
    return Link()
