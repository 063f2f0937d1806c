"""What tests of campaigns share."""

from __future__ import annotations

import pytest

from mutabot.campaign import preparation
from tests.campaign.scripted import Script


@pytest.fixture
def script(monkeypatch: pytest.MonkeyPatch) -> Script:
    """Campaigns start no process; how tests end is what this says."""
    script = Script()
    monkeypatch.setattr(preparation, "open_executor", script.opened)
    return script
