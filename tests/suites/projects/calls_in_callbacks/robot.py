"""A robot that calls the program back, in all the ways that libraries have."""

import asyncio
import contextvars
import threading


class Arm:
    def __init__(self):
        self.x = 0.0
        self.closed = False
        self.log = []
        self.handlers = {}
        self.context = None

    def move(self, x):
        self.x += x
        self.log.append(round(x, 3))

    def grip(self, closed):
        self.closed = closed

    def home(self):
        # its own doing: no call of the program's
        self.move(-self.x)
        self.grip(False)

    def goto(self, x, on_done=None):
        self.x = x
        if on_done is not None:
            on_done(self)

    def retry(self, function, *given):
        for _ in range(3):
            try:
                return function(*given)
            except RuntimeError:
                pass
        return None

    def on(self, event, handler):
        self.handlers.setdefault(event, []).append(handler)
        self.context = contextvars.copy_context()

    def emit(self, event):
        for handler in self.handlers.get(event, ()):
            handler(self)

    def tick(self):
        self.context.run(self.emit, "tick")

    def follow(self, path):
        for x in path:
            self.x += x

    def run_in_thread(self, function):
        context = contextvars.copy_context()
        thread = threading.Thread(target=context.run, args=(function,))
        thread.start()
        thread.join()

    def later(self, function):
        asyncio.get_running_loop().call_later(0.001, function, self)

    def begin(self, work):
        self.task = asyncio.get_running_loop().create_task(work)

    async def amove(self, x, on_done=None):
        # two tasks of its own
        await asyncio.gather(self.half(x / 2), self.half(x / 2))
        if on_done is not None:
            await on_done(self)

    async def half(self, x):
        await asyncio.sleep(0)
        self.move(x)


class Program:
    """What a robot runs: a program fills in its steps."""

    def __init__(self, arm):
        self.arm = arm

    def run(self):
        self.begin()
        self.arm.move(0.5)
        self.end()

    def begin(self):
        """For a program."""

    def end(self):
        """For a program."""
