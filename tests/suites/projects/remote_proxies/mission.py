def look_around(server):
    arm = server.arm
    arm.turn(90)
    arm.vacuum(True)
    seen = [arm.angle()]
    arm.turn(angle=-30)
    return [*seen, arm.angle()]
