"""The lowest versions that are allowed are said thrice, and are the same."""

import re
import tomllib
from pathlib import Path

import yaml

ROOT = Path(__file__).parents[2]


def version(text):
    """`3.9` and `3.9.0` are the same."""
    return re.sub(r"(\.0)+$", "", text)


def bounds(requirements, sign):
    """Versions by lower-case name of lines like `numpy>=2.0`."""
    pairs = (re.split(rf"\s*{sign}", line, maxsplit=1) for line in requirements)
    return {name.strip().lower(): version(number) for name, number in pairs}


def test_lower_bounds_are_the_same_wherever_they_are_said():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    asked = bounds(project["dependencies"], ">=")
    lines = (ROOT / "constraints-lowest.txt").read_text(encoding="utf-8").splitlines()
    lowest = bounds((line for line in lines if "==" in line), "==")
    assert {name: lowest[name] for name in asked} == asked
    text = (ROOT / "workflow" / "envs" / "campaign.yaml").read_text(encoding="utf-8")
    environment = bounds(yaml.safe_load(text)["dependencies"], ">=")
    assert environment.pop("python") == version(project["requires-python"].removeprefix(">="))
    environment["matplotlib"] = environment.pop("matplotlib-base")
    assert environment.items() <= asked.items()
    rules = (ROOT / "workflow" / "rules" / "campaign.smk").read_text(encoding="utf-8")
    assert f'min_version("{asked["snakemake"]}")' in rules
