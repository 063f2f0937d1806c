def follow(arm, path):
    reached = arm.follow(path)
    arm.tool("off")
    return [pose[2] for pose in reached]


def trace_square(arm, size):
    corners = [[0.0, 0.0, 0.1], [size, 0.0, 0.1], [size, size, 0.1], [0.0, size, 0.1]]
    arm.tool("on")
    heights = follow(arm, corners)
    return min(heights)
