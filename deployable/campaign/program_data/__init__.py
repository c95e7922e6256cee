"""What comes along with the program: the workflow, its profiles, campaigns and structures.

`workflow` and `config` are links to the checkout's folders, which a wheel has as files."""

from pathlib import Path

_FOLDER = Path(__file__).parent

WORKFLOW = (_FOLDER / "workflow").resolve()
CONFIG = (_FOLDER / "config").resolve()
SNAKEFILE = str(WORKFLOW / "Snakefile")  # the workflow, for `module:` of other workflows
RULES = str(WORKFLOW / "rules" / "campaign.smk")
"""Its rules without the one that asks for results, for `include:`."""


def list_campaigns() -> dict[str, Path]:
    """Return the paths of the shipped campaigns' configs (YAML), by file name without suffix."""
    return {path.stem: path for path in sorted(CONFIG.glob("*.yaml"))}


def list_structures() -> dict[str, Path]:
    """Return the paths of the shipped structures' files (YAML), by file name without suffix."""
    return {path.stem: path for path in sorted(CONFIG.glob("structures/*.yaml"))}
