"""What MuJoCo's viewer is given; the window itself needs a screen."""

from __future__ import annotations

import pytest

from mutabot.errors import UsageError
from packages.motion.sample import recording, shown

pytest.importorskip("mujoco")

from mutabot_motion.view import Stage, need_screen, show


def test_both_sides_stand_where_they_were_at_a_time() -> None:
    stage = Stage(shown())
    assert sorted(stage.things) == ["mutant a box", "mutant tool", "original a box", "original tool"]
    stage.at(1.5)
    assert stage.data.body("original a box").xpos == pytest.approx([0.75, 0.0, 0.3], abs=1e-6)
    assert stage.data.body("mutant a box").xpos == pytest.approx([0.5, 0.0, 0.025], abs=1e-6)
    stage.at(0.0)
    assert stage.data.body("mutant a box").xpos == pytest.approx([0.0, 0.0, 0.3], abs=1e-6)
    assert stage.end == 2.0


def test_it_says_the_time_the_fault_and_later_what_happened() -> None:
    stage = Stage(shown())
    assert "fault at 1.00 s" in stage.said(0.5)
    assert "slipped" not in stage.said(0.5)
    assert "FAULT since 1.00 s" in stage.said(1.5)
    assert "slipped" in stage.said(1.5)
    assert stage.said(1.5).isascii()


def test_a_thing_that_never_moved_and_one_side_alone_can_be_shown() -> None:
    still = recording()
    track = still.tracks["a box"]
    track.values = track.values[:3] * len(still.times)
    assert len(Stage(shown(original=still, mutant=None)).things) == 2


def test_without_a_screen_it_is_refused_with_what_does_without(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setattr("sys.platform", "linux")
    with pytest.raises(UsageError, match=r"needs a screen.*--video FILE\.mp4"):
        need_screen()


def test_with_nothing_to_show_no_window_is_opened(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("DISPLAY", ":99")
    with pytest.raises(UsageError, match="nothing to show"):
        show(shown(original=recording(tracks={}), mutant=None))
