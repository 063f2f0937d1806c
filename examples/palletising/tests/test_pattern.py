"""Does the pattern make a pallet that stands?"""

from __future__ import annotations

from itertools import combinations

from pattern import GAP, HEIGHT, LAYERS, LENGTH, WIDTH, Slot, layer, slots

DECK = (0.4, 0.3)
"""Of the pallet, x and y."""
Rectangle = tuple[float, float, float, float]


def rectangle(slot: Slot) -> Rectangle:
    """What a box in it covers: least x, most x, least y, most y."""
    x, y = (WIDTH, LENGTH) if slot.across else (LENGTH, WIDTH)
    return (slot.x - x / 2, slot.x + x / 2, slot.y - y / 2, slot.y + y / 2)


def overlap(first: Slot, second: Slot, gap: float = 0.0) -> bool:
    """Whether less than a gap is between them."""
    (a, b, c, d), (e, f, g, h) = rectangle(first), rectangle(second)
    return a - gap < f and e - gap < b and c - gap < h and g - gap < d


def test_there_are_27_places_layer_by_layer_from_below() -> None:
    heights = [round(slot.z / HEIGHT, 9) for slot in slots()]
    assert heights == [0] * 9 + [1] * 9 + [2] * 9


def test_boxes_of_a_layer_keep_the_gap() -> None:
    for number in range(LAYERS):
        for first, second in combinations(layer(number), 2):
            assert not overlap(first, second, GAP - 1e-9), (first, second)


def test_all_boxes_stand_on_the_deck_about_its_middle() -> None:
    for number in range(LAYERS):
        sides = list(zip(*map(rectangle, layer(number)), strict=True))
        ends = (min(sides[0]), max(sides[1]), min(sides[2]), max(sides[3]))
        assert abs(ends[0] + ends[1]) < 1e-9
        assert abs(ends[2] + ends[3]) < 1e-9
        assert ends[1] <= DECK[0] / 2
        assert ends[3] <= DECK[1] / 2


def test_layers_interlock() -> None:
    """Every box above the first layer rests on more than one."""
    for number in range(1, LAYERS):
        below = layer(number - 1)
        assert all(sum(overlap(slot, other) for other in below) > 1 for slot in layer(number))


def test_the_place_of_a_box_is_free_from_above() -> None:
    """No place is filled before those below it."""
    for number, slot in enumerate(slots()):
        later = slots()[number + 1 :]
        assert not any(other.z < slot.z and overlap(slot, other) for other in later)
