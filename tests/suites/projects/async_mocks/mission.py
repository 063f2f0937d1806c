import asyncio


async def sweep(arm):
    await arm.move_by(0.2)
    task = asyncio.create_task(arm.move_by(dx=-0.1))
    x = await arm.position()
    await task
    if x > 0.15:
        await arm.stop()
    return x
