class Stacker:
    """Puts parts on each other, by any arm."""

    def __init__(self, arm):
        self._arm = arm

    def stack(self, height):
        self._arm.vacuum(True)
        self._arm.move_by(-height)
        self._arm.move_by(dx=0.5, speed=0.3)
        self._arm.vacuum(on=False)
        return self._arm.position()
