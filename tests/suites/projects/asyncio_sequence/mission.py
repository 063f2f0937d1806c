import asyncio


async def serve(waiter, tables):
    served = []
    for table in tables:
        await waiter.go(table * 1.5)
        weight = await waiter.weigh()
        if weight > 0.5:
            await waiter.put_down()
            served.append(table)
    task = asyncio.create_task(waiter.go(0.0))
    await task
    return served


def main(waiter, tables):
    return asyncio.run(serve(waiter, tables))
