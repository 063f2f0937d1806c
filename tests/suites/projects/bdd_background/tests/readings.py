def held(arm):
    return arm.look()
