import mission
import pytest
from robot import Vise


@pytest.fixture(scope="module", params=[20.0, 45.5], ids=["small", "large"])
def clamped(request):
    vise = Vise()
    mission.clamp(vise, request.param)
    return vise, request.param


def test_something_is_clamped(clamped):
    vise, _ = clamped
    assert vise is not None


def test_width(clamped):
    vise, width = clamped
    assert vise.gap == pytest.approx(width)


def test_locked(clamped):
    assert clamped[0].locked
