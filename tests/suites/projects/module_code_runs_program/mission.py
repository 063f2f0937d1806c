def home_all(axes):
    for axis in axes:
        axis.jog(-5)
        axis.zero()
        axis.jog(1)
    return [axis.position() for axis in axes]
