"""Two arms: one follows the other in a mirror, and both hold a tray."""

MIRRORED = (-1, 1, -1)
LIMITS = ((-170.0, 170.0), (-90.0, 90.0), (-170.0, 170.0))
STEP = 5.0
REACH = 0.8
READY = (0.0, 45.0, 0.0)
SOFT, FIRM = 10.0, 40.0


class Twins:
    """The program."""

    def __init__(self, left, right, panel):
        self.left, self.right, self.panel = left, right, panel
        self.holding = False
        self.followed = []

    def start(self):
        for arm in (self.left, self.right):
            arm.enable()
            arm.move_joints(list(READY), blocking=True)
        self.holding = False

    def follow(self):
        """The right arm goes, in small steps, where the left one is in the mirror."""
        goal = [sign * angle for sign, angle in zip(MIRRORED, self.left.read_joints())]
        now = self.right.read_joints()
        step = [self.towards(a, b) for a, b in zip(now, goal)]
        limited = [min(max(angle, low), high) for angle, (low, high) in zip(step, LIMITS)]
        self.right.move_joints(limited, blocking=False)
        self.followed.append(limited)
        return limited == goal

    def towards(self, now, goal):
        return now + min(max(goal - now, -STEP), STEP)

    def grip(self, fragile=False):
        force = SOFT if fragile else FIRM
        self.left.close_hand(force=force)
        self.right.close_hand(force=force)
        self.holding = self.left.feels() and self.right.feels()
        if not self.holding:
            self.left.open_hand()
            self.right.open_hand()
        return self.holding

    def lift(self, height):
        if not self.holding:
            return False
        x, y, z = self.left.read_place()
        if z + height > REACH:
            return False
        self.left.move_place(x, y, z + height, blocking=False)
        x, y, z = self.right.read_place()
        self.right.move_place(x, y, z + height, blocking=True)
        return True

    def buttons(self):
        if self.panel.left_pressed():
            self.left.open_hand()
        if self.panel.right_pressed():
            self.right.open_hand()
        if self.panel.left_pressed() or self.panel.right_pressed():
            self.holding = False

    def stop(self):
        self.left.halt()
        self.right.halt()
        self.left.disable()
        self.right.disable()
        self.followed.clear()

    def path(self):
        return list(self.followed)
