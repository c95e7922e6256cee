"""Figures drawn beside a campaign: a second process that is ready when there is something to draw.

Importing matplotlib and drawing take longer than the runs of a small campaign.
"""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from contextlib import suppress
from importlib import import_module
from pathlib import Path

from deployable.campaign.config.sections import Campaign, as_json
from deployable.campaign.errors import CampaignError
from deployable.campaign.folder import Folder
from deployable.campaign.stages import STAGES

_READY = (
    "matplotlib.backends.backend_agg", "matplotlib.backends.backend_pdf", "matplotlib.figure",
    "netCDF4", "scipy.io",
)  # fmt: skip


# Ctrl-C goes to both processes; the one that asked tells. While Python starts it is ignored: it
# would tell of itself.
_CHILD = """
import signal
import deployable.__main__  # its settings of Python
signal.signal(signal.SIGINT, signal.SIG_DFL)
from deployable.campaign.drawing import draw
from deployable.campaign.stopping import leave
draw()
leave(0)
"""


def _ignore_ctrl_c() -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)


class Draughtsman:
    """A process that draws the stages that it is asked for; leaving the context waits for it."""

    def __enter__(self) -> Draughtsman:
        root = str(Path(__file__).parents[2])
        paths = os.pathsep.join(filter(None, [root, os.environ.get("PYTHONPATH")]))
        self.process = subprocess.Popen(
            [sys.executable, "-P", "-c", _CHILD],  # no module from the campaign's folder
            stdin=subprocess.PIPE,
            env={**os.environ, "PYTHONPATH": paths},
            preexec_fn=_ignore_ctrl_c,
            text=True,
        )
        return self

    def ask(self, stage: str, campaign: Campaign, folder: Folder) -> None:
        """Have one stage drawn, as soon as those before it are."""
        sections = as_json(**STAGES[stage].sections_of(campaign))
        order = {"stage": stage, "folder": str(folder.path), "sections": json.loads(sections)}
        with suppress(BrokenPipeError):  # leaving the context tells
            print(json.dumps(order), file=self.process.stdin, flush=True)

    def __exit__(self, kind: type | None, *rest: object) -> None:
        if kind is KeyboardInterrupt:
            self.process.terminate()
        with suppress(BrokenPipeError):  # what was asked for is still to be flushed
            self.process.stdin.close()
        if self.process.wait() and kind is None:
            raise CampaignError("the figures could not be drawn, see above")


def draw() -> None:
    """Draw what the lines of standard input ask for."""
    for name in _READY:  # before the first line comes
        import_module(name)

    for line in sys.stdin:
        order = json.loads(line)
        stage = STAGES[order["stage"]]
        sections = stage.typed(order["sections"])
        try:
            stage.run(Folder(order["folder"]), lambda text: None, **sections)
        except CampaignError as error:
            print(f"error: {error}", file=sys.stderr)
            sys.exit(1)
