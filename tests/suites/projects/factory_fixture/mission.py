def transfer(arm, start, goal):
    arm.go(start)
    arm.suck(True)
    arm.go(goal)
    arm.suck(False)
