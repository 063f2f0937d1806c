import asyncio


async def both(left, right):
    async with asyncio.TaskGroup() as group:
        group.create_task(reach(left, 0.3))
        group.create_task(reach(right, -0.3))
    await left.retract(0.1)


async def reach(arm, distance):
    await arm.extend(distance)
    await arm.extend(distance)
    await arm.grip(True)
