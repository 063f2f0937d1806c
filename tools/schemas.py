"""What tests of reports take from npm: published schemas of formats, and axe, which looks at pages.

Fetched once and kept in the environment; nothing of it is copied into the repository. Use: ``python
tools/schemas.py``; without npm, or without a network, it says so, and the tests that need it skip themselves.
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
    """A package, and the file in it that is wanted."""

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
#: finds what keeps people from using a page; never shipped
AXE = Source("axe-core", "4.14.1", "axe.min.js")


class NoSchemaError(Exception):
    """A file that cannot be fetched here, with the reason."""


def schema(name: str) -> dict[str, Any]:
    """The schema of a format. Raises NoSchemaError where it is not kept and cannot be fetched."""
    found: dict[str, Any] = json.loads(text(SOURCES[name]))
    return found


def text(source: Source) -> str:
    """The text of a file. Raises NoSchemaError where it is not kept and cannot be fetched."""
    kept = HOME / f"{source.package}-{source.version}-{Path(source.file).name}"
    if not kept.is_file():
        data = _fetched(source)
        HOME.mkdir(exist_ok=True)
        new = kept.with_suffix(".new")
        new.write_bytes(data)
        new.replace(kept)
    return kept.read_text(encoding="utf-8")


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
    for source in (*SOURCES.values(), AXE):
        try:
            text(source)
        except NoSchemaError as error:
            print(f"no {source.package}: {error}; the tests that need it skip themselves")
    return 0


if __name__ == "__main__":
    sys.exit(main())
