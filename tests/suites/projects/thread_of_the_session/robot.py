import queue
import threading


class Controller:
    """Moves the arm in a thread of its own."""

    def __enter__(self):
        self._at = {"z": 0.0, "angle": 0.0}
        self._steps = queue.Queue()
        self._thread = threading.Thread(target=self._work)
        self._thread.start()
        return self

    def __exit__(self, *error):
        self._steps.put(None)
        self._thread.join()

    def step(self, axis, by):
        self._steps.put((axis, by))

    def at(self, axis):
        self._steps.join()
        return self._at[axis]

    def _work(self):
        while (step := self._steps.get()) is not None:
            axis, by = step
            self._at[axis] = round(self._at[axis] + by, 6)
            self._steps.task_done()


class Arm:
    def __init__(self, controller):
        self.controller = controller

    def lift(self, dz):
        self.controller.step("z", dz)

    def turn(self, angle):
        self.controller.step("angle", angle)
