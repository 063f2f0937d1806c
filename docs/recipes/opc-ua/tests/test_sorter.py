import asyncio

from asyncua import Client
from plant import Plant, address

from sorter import sort


def run(heights):
    async def session():
        async with Plant(heights) as plant, Client(address()) as client:
            tall = await sort(client, len(heights))
            return plant, tall, await plant.belt.read_value()

    return asyncio.run(session())


def test_tall_parts_go_aside():
    plant, tall, _ = run([0.03, 0.08, 0.02, 0.06])
    assert plant.tall == [0.08, 0.06]
    assert plant.short == [0.03, 0.02]
    assert tall == 2


def test_the_belt_stands_still_at_the_end():
    _, _, speed = run([0.03])
    assert speed == 0.0
