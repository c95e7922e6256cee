"""Quantities, requirements and choices in the workflow: the same files, no more work."""

from __future__ import annotations

import json
import re

import pytest
import yaml

from deployable import campaign
from fpm.files.seals import unseal

CONFIG = """\
campaign: opening
scene: {file: structures/panel.yaml, parameters: {elements: 2}}
solver: {duration: 2.2, instants: 221}
intervals:
  k: {nominal: 0.1, relative: 0.05}
  mass: {nominal: 1, relative: 0.02}
design: {method: tensor_roots, order: 2}
held_out: 0
responses:
  psi: {opening: hinge}
quantities:
  t_open: {crossing: psi, level: 1.5}
requirements:
  in_time: {t_open: {at_most: 1.85}}
choose:
  parameters: {k: [0.09, 0.11]}
  minimise: upper(t_open)
"""
ANSWERS = ("quantities.nc", "requirements.json", "choice.json")


@pytest.mark.slow
def test_the_workflow_answers_what_a_campaign_in_one_call_does(workplace):
    path = workplace.config("opening", CONFIG)
    done = workplace.snakemake("--configfile", path)
    assert done.returncode == 0, done.stdout
    assert "all requirements are met in " in done.stdout
    results = workplace.folder / "results" / "opening"
    assert (results / "figures" / "campaign" / "ranges.png").exists()
    other = workplace.folder / "other"
    campaign.run(path, other, figures=False, notify=lambda text: None)
    for name in ANSWERS:
        ours, theirs = unseal(results / name), unseal(other / "opening" / name)
        if name.endswith("json"):
            ours, theirs = json.loads(ours), json.loads(theirs)
            assert ours == theirs, name
    assert "Nothing to be done" in workplace.snakemake("--configfile", path, "--dry-run").stdout
    # Another requirement asks for no run of the design again.
    raw = yaml.safe_load(CONFIG)
    raw["requirements"]["in_time"]["t_open"]["at_most"] = 1.9
    path = workplace.config("opening", yaml.safe_dump(raw))
    dry = workplace.snakemake("--configfile", path, "--dry-run").stdout
    rules = re.findall(r"^(\w+)\s+\d+$", dry.split("Job stats:")[1].split("total")[0], re.M)
    assert set(rules) == {"all", "answers", "figures", "page"}
