def dock(agv):
    agv.forward(2.0)
    agv.turn(180)
    agv.forward(-0.5)
    agv.latch()


def undock(agv):
    agv.unlatch()
    agv.forward(0.5)
