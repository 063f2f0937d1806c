import atexit
import os


@atexit.register  # before that of the program, so that it runs after it
def look_where_it_ended():
    from mission import ARM

    if ARM.z != 0.0 or abs(ARM.angle) > 1.0:
        os._exit(3)
