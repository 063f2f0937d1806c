def assemble(station):
    with station.powered():
        with station.gripping("cap") as grip:
            station.press(12.0)
            grip.squeeze(True)
        station.press(-12.0)
