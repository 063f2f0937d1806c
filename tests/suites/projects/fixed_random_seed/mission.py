def pick_from_bin(arm, scanner, tries=4):
    for attempt in range(1, tries + 1):
        x = scanner.find()
        arm.reach(x)
        arm.grip(True)
        if arm.holding():
            return attempt
        arm.grip(False)
    return 0
