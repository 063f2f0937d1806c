"""``mutabot live``: a campaign with a page in a browser."""

from __future__ import annotations

from typing import Annotated, Unpack

import typer

from mutabot.cli import options
from mutabot.cli.campaign import show_end
from mutabot.cli.output import tell
from mutabot.cli.request import request_of

from .live import Live

Port = Annotated[
    int | None,
    typer.Option("--port", metavar="N", min=1, max=65535, help="Port on this machine; else a free one."),
]


def live(
    context: typer.Context,
    port: Port = None,
    min_score: options.MinScore = None,
    json: options.Json = False,
    executor: tuple[str, str] | None = None,
    **given: Unpack[options.Running],
) -> None:
    """Run the campaign and show its report in a browser while it fills, with pause and stop."""
    request = request_of(context.obj, executor=executor, evidence=True, **given)
    with Live(request, port or 0, lambda text: tell([f"mutabot: {text}"])) as served:
        tell([f"mutabot: live at {served.address}"])
        show_end(request, served.run, min_score, json=json)
