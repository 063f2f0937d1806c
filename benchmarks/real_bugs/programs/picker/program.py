"""Finds a part, picks it up and puts it down."""

HOME = (0.0, 0.0)
BIN = (0.5, -0.25)
SOFT = 5.0


class Picker:
    """The program."""

    def __init__(self, arm, gripper, camera):
        self.arm, self.gripper, self.camera = arm, gripper, camera
        self.driven = []
        self.failed = False

    def run(self, soft=False):
        self.failed = False
        part = self.find()
        if part is None:
            self.failed = True
            return False
        self.pick(part, soft)
        if not self.gripper.is_holding():
            self.release()
            self.failed = True
            return False
        self.put()
        return True

    def find(self):
        self.arm.move_to(0.2, 0.1, blocking=False)
        self.arm.wait(0.5)
        return self.camera.look()

    def pick(self, part, soft=False):
        self.gripper.open()
        self.go(part[0], part[1])
        self.gripper.close(force=SOFT if soft else 20.0)

    def put(self):
        self.go(*BIN)
        self.release()

    def release(self):
        self.gripper.open()
        self.go(*HOME)

    def go(self, x, y):
        before = list(self.arm.where())
        self.arm.move_to(x, y, blocking=True)
        after = self.arm.where()
        self.driven.append((after[0] - before[0], after[1] - before[1]))

    def may_idle(self):
        return not self.gripper.is_holding()
