def place_box(sim):
    sim.box()[2] = 0.25


def nudge_box(sim):
    sim.box()[0] += 0.5


def raise_tool(sim):
    pose = sim.tool()
    pose[2] += 0.1
    sim.go(pose)


def is_high(sim):
    return sim.box()[2] > 0.5
