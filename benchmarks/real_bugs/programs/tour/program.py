"""Shows the tool at named poses, and turns a joint back and forth until somebody says stop."""

HOME = "home"
#: joint angles, degrees
POSES = {
    "conveyor": (0, 26, 180, -78, 0, -76, 90),
    "table": (-145, 26, 180, -78, 0, -76, 90),
    "camera": (20, 15, 180, -100, 0, -60, 90),
}
#: degrees: what joints 1, 2, 4 and 6 may do
LIMITS = {0: (-160.0, 160.0), 1: (-120.0, 120.0), 3: (-140.0, 140.0), 5: (-115.0, 115.0)}
#: of the full speed
SLOW, FAST = 0.3, 1.0
#: degrees: nearer than that it has arrived
NEAR = 1.0


def folded(angle):
    """The same angle from -180 to 180 degrees."""
    return (angle + 180.0) % 360.0 - 180.0


class Tour:
    """The program."""

    def __init__(self, cell):
        self.cell = cell
        self.visited = []
        self.careful = False

    def visit(self, names):
        """Go to each pose; return the names of those that are reached."""
        self.visited.clear()
        for name in names:
            if name == HOME:
                self.cell.arm.home()
            elif name not in POSES:
                continue
            else:
                self.cell.arm.move_joints(POSES[name], speed=SLOW if self.careful else FAST)
            if name == HOME or self.is_at(POSES[name]):
                self.visited.append(name)
        return list(self.visited)

    def is_at(self, angles):
        measured = self.cell.sensors.joint_angles()
        return all(abs(folded(a - b)) < NEAR for a, b in zip(measured, angles))

    def wave(self, joint, swing, until):
        """Turn a joint by so many degrees and back until somebody says stop; return how often."""
        start = list(self.cell.arm.commanded_joints())
        low, high = LIMITS.get(joint, (-180.0, 180.0))
        count = 0
        while not until():
            there = list(start)
            there[joint] = min(max(folded(start[joint] + swing), low), high)
            self.cell.arm.move_joints(there, speed=SLOW)
            self.cell.arm.move_joints(start, speed=SLOW)
            count += 1
        return count

    def creep(self, name, is_seen):
        """Go to a pose slowly, and stop on the way as soon as something is seen; whether it was."""
        move = self.cell.arm.start_move_joints(POSES[name], speed=SLOW)
        while not move.done:
            if is_seen():
                move.stop()
                return True
            self.cell.wait(0.05)
        return False
