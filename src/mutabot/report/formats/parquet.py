"""Parquet: the table of the CSV with its types, for data frames. Needs pyarrow: ``mutabot[notebook]``."""

from __future__ import annotations

from typing import Any

from mutabot.analysis.stored.table import COLUMNS, missing, rows
from mutabot.report.format import Format, Material


def make(material: Material) -> bytes:
    """The report. Raises UsageError if pyarrow is not installed."""
    try:
        import pyarrow  # noqa: PLC0415  # an extra, and slow
        from pyarrow import parquet  # noqa: PLC0415
    except ImportError as error:
        raise missing("pyarrow", "the format parquet") from error
    cells = list(zip(*rows(material.campaign.results), strict=True)) or [() for _ in COLUMNS]
    types = {str: pyarrow.string(), int: pyarrow.int64(), float: pyarrow.float64(), bool: pyarrow.bool_()}
    schema = pyarrow.schema(
        [pyarrow.field(one.name, types[one.kind], metadata={"meaning": one.meaning}) for one in COLUMNS],
        metadata=_metadata(material),
    )
    arrays = [pyarrow.array(list(those), type=schema.field(index).type) for index, those in enumerate(cells)]
    sink = pyarrow.BufferOutputStream()
    parquet.write_table(pyarrow.table(arrays, schema=schema), sink)
    made: bytes = sink.getvalue().to_pybytes()
    return made


def _metadata(material: Material) -> dict[str, Any]:
    campaign = material.campaign
    facts = {key: campaign.meta.get(key) for key in ("mutabot", "seed", "rounds", "engine")}
    return {f"mutabot.{key}": str(value) for key, value in {**facts, "state": campaign.state}.items()}


FORMAT = Format("parquet", make)
