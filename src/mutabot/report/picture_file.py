"""Pictures as files, in SVG."""

from __future__ import annotations

from pathlib import Path

from mutabot.errors import UsageError

from .picture import Picture, svg


def check_picture(path: Path) -> None:
    """Raise UsageError for a file that could not be written; said before a campaign rather than after it."""
    if path.suffix.lower() != ".svg":
        raise UsageError(f"{path} is no picture that can be drawn: pictures are SVG; write {_svg_name(path)}")
    if path.is_dir() or not path.parent.is_dir():
        what = "a folder is" if path.is_dir() else "there is no folder"
        raise UsageError(
            f"the picture {path} cannot be written: {what} {path if path.is_dir() else path.parent}"
        )


def write_drawing(picture: Picture, path: Path, *, by: str) -> None:
    """Write a drawing, which says by which command. Raises UsageError if the file cannot be written."""
    try:
        path.write_text(svg(picture, by), encoding="utf-8")
    except OSError as error:
        raise UsageError(f"the picture {path} cannot be written: {error.strerror}") from error


def _svg_name(path: Path) -> Path:
    return path.with_suffix(".svg") if path.name else Path("ends.svg")
