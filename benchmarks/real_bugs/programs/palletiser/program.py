"""Stacks boxes on a pallet, layer by layer, each second layer turned."""

COLUMNS, ROWS, LAYERS = 3, 2, 4
LENGTH, WIDTH, HEIGHT = 0.4, 0.3, 0.2
GAP = 0.01
ORIGIN = (0.5, -0.4, 0.1)
PICK = (0.0, 0.6, 0.3)
LIFT = 0.25
HEAVY = 12.0


class Palletiser:
    """The program."""

    def __init__(self, robot, cup, scale):
        self.robot, self.cup, self.scale = robot, cup, scale
        self.count = 0
        self.lost = []

    def run(self, boxes):
        for _ in range(boxes):
            if self.is_full():
                return False
            self.stack()
        return True

    def is_full(self):
        return self.count >= COLUMNS * ROWS * LAYERS

    def stack(self):
        weight = self.pick()
        if weight is None:
            self.lost.append(self.count)
            return False
        x, y, z, turn = self.slot(self.count)
        slow = weight > HEAVY
        self.robot.move_to(x, y, z + LIFT, turn, speed=self.speed(weight))
        self.robot.move_to(x, y, z, turn, speed=0.1 if slow else 0.3)
        self.cup.release()
        self.robot.move_to(x, y, z + LIFT, turn)
        self.count += 1
        return True

    def pick(self):
        x, y, z = PICK
        self.robot.move_to(x, y, z + LIFT, 0.0)
        self.robot.move_to(x, y, z, 0.0)
        self.cup.grip()
        self.robot.wait(0.3)
        if not self.cup.has_vacuum():
            self.cup.release()
            return None
        self.robot.move_to(x, y, z + LIFT, 0.0)
        return self.scale.read() / 1000.0

    def slot(self, number):
        layer, place = divmod(number, COLUMNS * ROWS)
        row, column = divmod(place, COLUMNS)
        turned = layer % 2 == 1
        if turned:
            row, column = ROWS - 1 - row, COLUMNS - 1 - column
        x = ORIGIN[0] + column * (LENGTH + GAP) + LENGTH / 2
        y = ORIGIN[1] + row * (WIDTH + GAP) + WIDTH / 2
        z = ORIGIN[2] + (layer + 1) * HEIGHT
        return x, y, z, 180.0 if turned else 0.0

    def speed(self, weight):
        return max(0.2, 1.0 - 0.05 * weight)

    def new_pallet(self):
        done = list(self.lost)
        self.count = 0
        self.lost.clear()
        return done
