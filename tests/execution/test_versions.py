"""Names and versions of what is installed are those that its metadata says."""

from __future__ import annotations

from importlib.metadata import PathDistribution, distributions
from pathlib import Path

import pytest

from mutabot.execution.versions import name_and_version


def test_all_that_is_installed_has_its_name_and_version() -> None:
    for distribution in distributions():
        known = (distribution.metadata["Name"].lower(), distribution.version)
        assert name_and_version(distribution) == known


@pytest.mark.parametrize(
    ("text", "known"),
    [
        ("Metadata-Version: 2.1\nName: Arm\nVersion: 1.0\n", ("arm", "1.0")),
        ("name: Arm\r\nVERSION:1.0\r\n\r\nName: other\r\n", ("arm", "1.0")),
        ("Name: arm\nSummary: moves\n Name: it\nVersion: 1.0\n\nVersion: 2.0\n", ("arm", "1.0")),
        ("Name: arm\nName: leg\n", ("arm", "")),
        ("\nName: arm\n", ("", "")),
        ("", ("", "")),
    ],
)
def test_only_the_fields_before_the_description_count(
    text: str, known: tuple[str, str], tmp_path: Path
) -> None:
    (tmp_path / "METADATA").write_text(text, encoding="utf-8", newline="")
    assert name_and_version(PathDistribution(tmp_path)) == known
