"""The floor: both directions of an offset, and checks that are narrower than their sensor's noise."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from mutabot.model import Operation, Vocabulary
from mutabot.results.ladders import ladders_of
from mutabot.results.thresholds import Floor, floors_of
from results import samples
from results.thresholds import journals
from results.thresholds.journals import Rungs

#: a reading whose sensor has a noise of 2 mm
NOISY = Vocabulary(
    operations=(
        Operation("tracker:box_position", result=(replace(samples.X, repeatability=0.002),), command=False),
    )
)


def floor(folder: Path, up: list[str], down: list[str], vocabulary: Vocabulary = NOISY) -> Floor:
    both = [
        Rungs(rounds, direction=sign, site=samples.READ, quantity=".x", operation="tracker:box_position")
        for sign, rounds in (("+", up), ("-", down))
    ]
    (found,) = floors_of(ladders_of(journals.results(folder, *both, vocabulary=vocabulary)))
    return found


def test_the_half_width_is_between_the_brackets_of_both_directions(tmp_path: Path) -> None:
    found = floor(tmp_path, ["SSSSCCC"], ["SSSCCCC"])
    assert found.half_width == (7.5, 15.0)
    assert found.pairs[0].bias == (0.0, 7.5)
    assert found.blind == (-10.0, 20.0)
    assert found.blind_text == "blind between −10 mm and +20 mm"


def test_rounds_that_move_both_ends_oppositely_narrow_the_half_width(tmp_path: Path) -> None:
    found = floor(tmp_path, ["SSSSCCC", "SSSCCCC"], ["SSSCCCC", "SSSSCCC"])
    assert found.half_width == (7.5, 15.0)
    assert [one.bias[0] < 0.0 for one in found.pairs] == [False, True]


def test_a_check_below_its_sensors_noise_is_told(tmp_path: Path) -> None:
    found = floor(tmp_path, ["CCCCCCC"], ["SCCCCCC"])
    assert found.noise == 2.0
    assert found.is_below_noise
    assert found.text == "notices 1 mm, sensor noise 2 mm; passes only by its seed"
    assert found.false_alarms is not None
    assert 0.4 < found.false_alarms < 0.5


def test_a_check_that_is_wide_enough_is_not(tmp_path: Path) -> None:
    assert not floor(tmp_path, ["SSSCCCC"], ["SSSCCCC"]).is_below_noise


def test_nothing_is_claimed_where_the_noise_is_not_known(tmp_path: Path) -> None:
    found = floor(tmp_path, ["CCCCCCC"], ["CCCCCCC"], samples.VOCABULARY)
    assert found.noise is None
    assert not found.is_below_noise
    assert found.false_alarms is None


def test_what_is_never_noticed_has_no_upper_end(tmp_path: Path) -> None:
    found = floor(tmp_path, ["SSSSSSS"], ["SSSCCCC"])
    assert found.blind_text == "blind between −10 mm and beyond +100 mm"
    assert not found.is_below_noise
