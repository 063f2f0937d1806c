import os


class Changer:
    """Knows its angle from the environment, as some vendors' tools do."""

    def rotate(self, deg):
        os.environ["CHANGER_ANGLE"] = str(self.angle() + deg)

    def angle(self):
        return int(os.environ.get("CHANGER_ANGLE", "0"))

    def lock(self, on):
        os.environ["CHANGER_LOCKED"] = str(on)
