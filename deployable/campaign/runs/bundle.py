"""Runs as one file, for jobs that share no folder and get declared files only."""

from __future__ import annotations

import shutil
import tarfile
from collections.abc import Iterable
from pathlib import Path

from deployable.campaign.errors import CampaignError
from deployable.campaign.files import whole_file


def pack(store: str | Path, bundle: str | Path) -> None:
    """Put all runs that are in a store into a tar file."""
    with whole_file(bundle) as temporary, tarfile.open(temporary, "w") as file:
        for path in sorted(Path(store).glob("*.nc")):
            file.add(path, path.name)


def unpack(bundles: Iterable[str | Path], store: str | Path) -> None:
    """Put the runs of bundles into a store, but those that are there already.

    Raises `CampaignError` for what is no bundle. A damaged run is told by its seal.
    """
    for bundle in bundles:
        try:
            with tarfile.open(bundle) as file:
                for member in file:
                    path = Path(store, Path(member.name).name)
                    if not member.isfile() or path.suffix != ".nc" or path.exists():
                        continue
                    with whole_file(path) as temporary, open(temporary, "wb") as copy:
                        shutil.copyfileobj(file.extractfile(member), copy)
        except tarfile.TarError as error:
            raise CampaignError(f"{bundle} holds no runs: {error}") from None
