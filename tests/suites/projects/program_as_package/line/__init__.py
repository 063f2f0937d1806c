from .pick import pick
from .place import place


def cycle(robot):
    grabbed = pick(robot)
    if grabbed:
        place(robot)
    return grabbed
