import atexit
import threading

from robot import Arm

ARM = Arm()


@atexit.register
def park():
    ARM.lift(-0.2)
    ARM.turn(1.0)


def turn_back():
    threading.main_thread().join()
    ARM.turn(-30.0)


def pick():
    threading.Thread(target=turn_back).start()
    ARM.lift(0.2)
    ARM.turn(30.0)
