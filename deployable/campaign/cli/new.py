"""A folder of one's own: a Snakefile of a few lines, profiles, and a campaign to edit."""

import math
import re
import shutil
from pathlib import Path

import fpm
from deployable.campaign import program_data
from deployable.campaign.config.loader import read_file
from deployable.campaign.config.sections import scene_type
from deployable.campaign.errors import CampaignError
from deployable.campaign.files import write_text
from deployable.campaign.folder import CAMPAIGN
from deployable.campaign.results.templates import environment
from fpm.files.outcome import eventful
from fpm.structures.plausible import run_duration

SNAKEFILE = f'''\
# The campaign of this folder: snakemake -c2
# Another one:                 snakemake -c2 --configfile other.yaml

from deployable.campaign.program_data import RULES

CAMPAIGN = "{CAMPAIGN}"


include: RULES


rule all:
    localrule: True
    default_target: True
    input:
        campaign_results(),
'''

GITIGNORE = "/results/\n/exports/\n/report.html\n/.snakemake/\n"


def list_starts() -> list[str]:
    """List names that a new folder can start from: shipped campaigns, structures without one."""
    campaigns = program_data.list_campaigns()
    scenes = [read_file(path).data["scene"] for path in campaigns.values()]
    scene_names = {scene.get("name") or Path(scene["file"]).stem for scene in scenes}
    return sorted({*campaigns, *(program_data.list_structures().keys() - scene_names)})


def make_folder(folder: str | Path, start: str) -> None:
    """Make `folder` with what `snakemake` and `python -m deployable run` need to run a campaign.
    start: one of `starts()`, or path of a structure's YAML file. Raises `CampaignError`, before
    writing, if one of the files exists or `start` is not known; also if it cannot write."""
    folder = Path(folder)
    campaign, structures = _start_files(start)
    paths = [folder / name for name in ("Snakefile", CAMPAIGN, "profiles", *structures)]
    if present := [str(path) for path in paths if path.exists()]:
        raise CampaignError(f"{', '.join(present)}: there already; allowed: a folder without")
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for name, path in structures.items():
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(path, folder / name)
        shutil.copytree(program_data.WORKFLOW / "profiles", folder / "profiles")
        write_text(folder / CAMPAIGN, campaign)
        write_text(folder / "Snakefile", SNAKEFILE)
        if not (folder / ".gitignore").exists():
            write_text(folder / ".gitignore", GITIGNORE)
    except OSError as error:
        raise CampaignError(f"{error.filename or folder}: {error.strerror or error}") from None


def _start_files(start: str) -> tuple[str, dict[str, Path]]:
    """Return the text of the campaign, and its structures' files by their names in the folder."""
    if start in list_starts() and (path := program_data.list_campaigns().get(start)):
        file = read_file(path).data["scene"].get("file")
        return path.read_text(encoding="utf-8"), {file: path.parent / file} if file else {}
    path = program_data.list_structures().get(start) if start in list_starts() else Path(start)
    if path is None or path.suffix != ".yaml" or not path.is_file():
        allowed = f"{', '.join(list_starts())}, or the .yaml file of a structure"
        raise CampaignError(f"--start {start} is not known; allowed: {allowed}")
    name, text = f"structures/{path.name}", campaign_of(path, f"structures/{path.name}")
    files = (f for f in scene_type("", str(path)).files if f.is_relative_to(path.parent))
    names = [f.relative_to(path.parent) for f in files if ".." not in f.parts]
    return text, {name: path} | {f"structures/{f}": path.parent / f for f in names}


def campaign_of(path: Path, name: str) -> str:
    """YAML text of a first campaign for the structure in the file `path`, called `name` in it: an
    interval of 1 % for the first real parameter that is not 0, speeds of all points and openings of
    all hinges, the times of its latches as quantities, and a requirement that all catch. Raises
    `CampaignError` if the structure cannot be read, or has no such parameter."""
    try:
        scene = scene_type("", str(path))
    except fpm.SceneError as error:
        raise CampaignError(str(error)) from None
    real = [key for key, p in scene.parameters.items() if p.default and not p.is_whole]
    if not real:
        raise CampaignError(f"{path} has no real parameter, so that nothing can be an interval")
    seconds, steps = run_duration(scene.sample), (1, 1.5, 2, 3, 5, 7.5, 10)
    power = 10 ** math.floor(math.log10(seconds))
    latches = [
        e.name.removeprefix("latch ") for e in eventful(scene.sample) if "latches" in e.events
    ]
    text = environment().get_template("campaign.yaml.jinja").render(
        structure=scene, file=name, uncertain=real[0], key=_name, repr=repr,
        campaign=re.sub("[^A-Za-z0-9_-]+", "-", path.stem).strip("-_"),
        duration=next(n for n in steps if seconds <= n * power * 1.000001) * power,
        catches={f"t_{_name(latch)}": latch for latch in latches},
    )  # fmt: skip
    return f"{text.rstrip()}\n"


def _name(text: str) -> str:
    """Turn a text into a name that a response or quantity can have."""
    return re.sub(r"\W+", "_", text)
