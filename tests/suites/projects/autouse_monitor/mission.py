def polish(disc):
    disc.spin(True)
    disc.press(0.4)
    disc.press(-0.4)
    disc.spin(False)


def pause(disc):
    disc.press(0.0)
