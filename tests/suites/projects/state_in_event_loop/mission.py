async def pick(arm):
    await arm.lift(0.2)
    arm.turn(30.0)
    await arm.lift(-0.05)
