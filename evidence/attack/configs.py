"""Configs changed at random: refused in words and at once, or run without a traceback."""

import copy
import random
from pathlib import Path
from typing import Any

import yaml

import fpm
from deployable import campaign
from deployable.campaign.config.check import load_config
from deployable.campaign.config.sections import Campaign, count_runs
from deployable.campaign.errors import CampaignError, ConfigError
from evidence.attack.ledger import Ledger
from evidence.attack.victim import RAW, silent

BASES = (
    RAW,
    RAW | {"design": {"method": "smolyak", "order": 2}, "held_out": 1},
    RAW | {
        "intervals": {"a": {"absolute": 0.0004}, "E": {"lower": 0.9e9, "upper": 1.1e9}},
        "design": {"method": "sobol", "order": 2, "samples": 9},
        "bounds": {"model": "spline"},
    },
    RAW | {"design": {"method": "sobol", "samples": 6, "seed": 3}},
    RAW | {"bounds": {"model": "spline"}, "published": {"BD": 0.06}, "error": {"shade_above": 0.1}},
)  # fmt: skip

NASTY: tuple[Any, ...] = (
    None, True, "", " ", "x", "auto", "norm", "B", "\n", "a\n", "../x", "x" * 300, "é", "1e9",
    ".nan", 0, 1, -1, 2, 3, 64, 65, 10**9, 10**400, 2**63, 0.0, -0.0, 1e-300, 5e-324, 1e300, 0.1,
    1e-9, 0.5, float("nan"), float("inf"), -float("inf"), [], {}, [[]], [1, 2], ["B", "D"],
    ["B", "B"], {"a": 1},
)  # fmt: skip
LINES = (
    "&a [*a]", "!!int abc", "!!python/object:os.system x", "2020-02-30", "[" * 50, "\x07", "\t",
)  # fmt: skip
KEYS = ("a", "E", "K_F", "order", "order ", "", "B" * 250, "x y")

COSTLY = 3e6
"""Steps times runs above which an accepted config is not simulated here."""


_DUMPER = getattr(yaml, "CSafeDumper", yaml.SafeDumper)


def mutate_config(rng: random.Random) -> str:
    """The text of a config that was changed in one to three places."""
    data = copy.deepcopy(rng.choice(BASES))
    for _ in range(rng.choice([1, 1, 2, 3])):
        _change(data, rng)
    text = yaml.dump(data, Dumper=_DUMPER, allow_unicode=True)
    if rng.random() < 0.15:
        lines = text.split("\n")
        row = rng.randrange(len(lines))
        action = rng.randrange(4)
        if action == 0:
            lines[row] = lines[row] + rng.choice(LINES)
        elif action == 1:
            lines.insert(row, lines[rng.randrange(len(lines))])
        elif action == 2:
            lines[row] = "  " + lines[row]
        else:
            lines[row] = lines[row][: len(lines[row]) // 2]
        text = "\n".join(lines)
    return text


def _change(data: Any, rng: random.Random) -> None:
    """Change one place of nested mappings and lists: a value, a key, or whether it is there."""
    places = list(_places(data))
    holder, key = rng.choice(places)
    draw = rng.random()
    if draw < 0.6:
        holder[key] = copy.deepcopy(rng.choice(NASTY))
    elif draw < 0.7 and type(holder[key]) in (int, float) and abs(holder[key]) < 1e12:
        holder[key] *= rng.choice([-1, 10, 1000, 1e-3, 1e6])
    elif draw < 0.8 and isinstance(holder, dict):
        holder[rng.choice(KEYS)] = holder.pop(key)
    elif draw < 0.9:
        del holder[key]
    else:
        source, name = rng.choice(places)
        holder[key] = copy.deepcopy(source[name])


def _places(data: Any) -> list[tuple[Any, Any]]:
    keys = list(data) if isinstance(data, dict) else range(len(data))
    places = [(data, key) for key in keys]
    for key in keys:
        if isinstance(data[key], dict | list):
            places += _places(data[key])
    return places


def attack_by_config(
    text: str, place: Path, ledger: Ledger, simulate: bool = True
) -> Campaign | None:
    """Check a config; what it means if it is accepted, to be simulated, and cheap."""
    place.mkdir(parents=True, exist_ok=True)
    path = place / "mutated.yaml"
    path.write_text(text, encoding="utf-8", errors="surrogatepass")
    campaigns: list[Campaign] = []

    def check() -> str:
        try:
            campaigns.append(load_config([path]))
        except ConfigError as error:
            if len(str(error)) > 20_000:
                raise RuntimeError(f"a message of {len(str(error))} letters") from None
            return "refused"
        return "right"

    ledger.attempt("config mutated", text, 10.0, check)
    return campaigns[0] if campaigns and simulate and _is_cheap(campaigns[0]) else None


def _is_cheap(case: Campaign) -> bool:
    """Whether a campaign takes seconds: its steps, as long as its nominal run lets them be, times
    its runs."""
    experiment = case.experiment
    if experiment.scene.parameters.get("elements", 12) > 4:
        return False
    steps = experiment.solver.duration / fpm.find_stable_step(experiment.nominal_scene).step
    return steps * count_runs(experiment) < COSTLY and experiment.solver.instants <= 5000


def attack_runs(case: Campaign, text: str, place: Path, ledger: Ledger) -> None:
    """Simulate what was accepted: bounds, or a sentence."""

    def run() -> str:
        try:
            bounds = campaign.run(case, place, figures=False, notify=silent)
        except CampaignError:
            return "refused"
        return "right" if bool((bounds["lower"] <= bounds["upper"]).all()) else "wrong"

    ledger.attempt("accepted config run", text, 120.0, run)
