"""The program runs once for the file; every test looks at one thing."""

import mission
import pytest
from robot import Torch


@pytest.fixture(scope="module")
def torch():
    return Torch()


@pytest.fixture(scope="module")
def end(torch):
    return mission.weld(torch)


def test_the_program_ends(end):
    assert end is not None


def test_two_seams(torch, end):
    assert len(torch.seams) == 2


def test_length(torch, end):
    for (x1, y1), (x2, y2) in torch.seams:
        assert abs(x2 - x1) == pytest.approx(30.0)


def test_torch_is_off(torch, end):
    assert not torch.lit


def test_end_in_x(end):
    assert end[0] == pytest.approx(10.0)
