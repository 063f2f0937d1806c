def deburr(tool):
    for side in range(4):
        tool.along(50.0)
        tool.turn(90)
    tool.stop()
