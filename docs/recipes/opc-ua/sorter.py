"""A sorting cell on OPC UA: parts on a belt are measured, and a gate sends the tall ones aside."""

LIMIT = 0.05


async def sort(client, parts):
    """Sort some parts; how many of them were tall."""
    cell = client.get_node("ns=2;s=Cell")
    belt = client.get_node("ns=2;s=Belt.Speed")
    gate = client.get_node("ns=2;s=Gate.Open")
    height = client.get_node("ns=2;s=Gauge.Height")
    tall = 0
    await belt.write_value(0.5)
    for _ in range(parts):
        is_tall = await height.read_value() > LIMIT
        tall += is_tall
        await gate.write_value(is_tall)
        await cell.call_method("2:Advance")
    await gate.write_value(False)
    await belt.write_value(0.0)
    return tall
