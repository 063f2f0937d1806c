def tour(arm, way):
    arm.move_by(way)
    reached = arm.position()
    arm.move_by(dx=0.25)
    if reached < 3:
        arm.home()
    return reached
