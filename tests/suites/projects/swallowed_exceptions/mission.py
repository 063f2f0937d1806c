from robot import Fault


def deliver(agv):
    trouble = []
    for stop in (3.0, 2.0, 4.0):
        try:
            agv.forward(stop)
            agv.bell(True)
        except Fault as fault:
            trouble.append(str(fault))
            agv.reset()
        except Exception:
            pass
    return trouble
