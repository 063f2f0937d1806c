import atexit
import os

import pytest
from robot import Arm

ARM = Arm()


@atexit.register
def look_where_it_ended():
    if ARM.z != 0.15:
        os._exit(1)


@pytest.fixture
def arm():
    return ARM
