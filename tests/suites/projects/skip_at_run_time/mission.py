def charge(agv):
    if agv.battery() < 40:
        agv.forward(5.0)
        agv.plug(True)
        return True
    return False
