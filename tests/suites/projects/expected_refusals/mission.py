from robot import OutOfReach


def reach(arm, x):
    arm.move_to(x)


def reach_first(arm, targets):
    for target in targets:
        try:
            arm.move_to(target)
        except OutOfReach:
            arm.note("skipped")
            continue
        return target
    return None


def face_back(arm):
    arm.turn_to(180)


def face_side(arm):
    arm.turn_to(90)


def slide(arm):
    status = arm.slide(3.0)
    arm.note(status)
    return status
