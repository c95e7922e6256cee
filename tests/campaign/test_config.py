"""Configs: what is refused, in which words, and what the defaults are."""

from __future__ import annotations

import copy
import json
from itertools import product
from pathlib import Path

import pytest
import yaml

from deployable.campaign.config.check import check_config, load_config, merge
from deployable.campaign.config.models import Solver
from deployable.campaign.config.sections import (
    Interval,
    corners,
    digest,
)
from deployable.campaign.errors import ConfigError

ROOT = Path(__file__).parents[2]


def change(raw: dict, key: str, value) -> dict:
    """Set a value by its dotted key; "-" takes it away."""
    *parents, last = key.split(".")
    place = raw
    for parent in parents:
        place = place.setdefault(parent, {})
    place[last] = value
    if value == "-":
        del place[last]
    return raw


TABLE = yaml.safe_load((Path(__file__).parent / "refusals.yaml").read_text(encoding="utf-8"))


@pytest.mark.parametrize("row", TABLE["refused"], ids=lambda row: str(row["change"]))
def test_what_is_wrong_is_told_with_key_value_and_what_is_allowed(row):
    raw = copy.deepcopy(TABLE["config"])
    for key, value in row["change"].items():
        change(raw, key, value)
    with pytest.raises(ConfigError) as error:
        check_config(raw, "my.yaml")
    wanted = [row["says"]] if isinstance(row["says"], str) else row["says"]
    assert error.value.problems == wanted
    count = "1 problem:" if len(wanted) == 1 else f"{len(wanted)} problems:"
    assert str(error.value).startswith(f"my.yaml has {count}")
    assert all("allowed: " in sentence for sentence in wanted)


def test_a_structure_is_told_from_a_campaign():
    with pytest.raises(
        ConfigError, match=r"has 1 problem:\n.*a structure's file, not a campaign's: use"
    ):
        load_config([ROOT / "config/structures/panel.yaml"])


def test_what_a_structure_refuses_is_told_with_its_file_and_line(raw):
    where = r"scene: at the nominal values \(a = 0\.035\): .*bennett\.yaml, line \d+: let\.left: "
    with pytest.raises(ConfigError, match=where):
        check_config(change(raw, "scene.parameters.start", 121))


@pytest.mark.parametrize("level", [10**20, 2**63, True])
def test_a_whole_number_that_no_array_holds_is_taken_as_a_number(raw, level):
    raw["quantities"] = {"t": {"crossing": next(iter(raw["responses"])), "level": level}}
    if level is True:
        with pytest.raises(ConfigError, match=r"quantities.t.level: true"):
            check_config(raw)
    else:
        found = check_config(raw).experiment.quantities["t"]
        assert found["level"] == float(level)


def test_defaults_are_those_of_the_models(raw):
    del raw["design"], raw["jobs"]
    config = check_config(raw)
    assert config.experiment.design.method == "tensor_roots"
    assert config.experiment.design.order == 3
    assert config.experiment.solver.safety == Solver().safety
    assert config.jobs.group == 64


@pytest.mark.parametrize(
    "definition",
    [
        {"nominal": 0.04, "relative": 0.05},
        {"nominal": 0.04, "absolute": 0.002},
        {"lower": 0.038, "upper": 0.042},
    ],
)
def test_an_interval_can_be_given_in_three_ways(raw, definition):
    interval = check_config(change(raw, "intervals", {"a": definition})).experiment.intervals["a"]
    found = (interval.lower, interval.nominal, interval.upper)
    assert found == pytest.approx((0.038, 0.04, 0.042), rel=1e-14)


def test_an_interval_without_nominal_is_about_the_scenes_value(raw):
    config = check_config(change(raw, "intervals", {"E": {"relative": 0.1}, "a": {"absolute": 0}}))
    intervals = config.experiment.intervals
    assert (intervals["E"].lower, intervals["E"].upper) == pytest.approx((0.9e9, 1.1e9))
    assert intervals["a"].lower == intervals["a"].nominal == intervals["a"].upper


def test_the_hash_knows_values_and_not_the_order_of_keys(raw):
    def hashed(raw):
        return digest(check_config(raw).experiment)

    turned = json.loads(json.dumps(dict(reversed(raw.items()))))
    assert hashed(turned) == hashed(raw)
    turned["solver"]["duration"] = 0.0040000000000000001
    assert hashed(turned) == hashed(raw)
    turned["solver"]["duration"] = 0.004000000000000001
    assert hashed(turned) != hashed(raw)


def test_the_hash_knows_what_an_interval_is_and_not_how_it_is_written(raw):
    hashes = {
        digest(check_config(change(raw, "intervals", {"E": definition})).experiment)
        for definition in (
            {"relative": 0.25},
            {"nominal": 1e9, "absolute": 250000000},
            {"lower": 750000000, "upper": 1.25e9},
        )
    }
    assert len(hashes) == 1


def test_merging_changes_single_keys_and_leaves_its_arguments_alone():
    base = {"a": {"b": 1, "c": 2}, "d": 3}
    other = {"a": {"c": 4}, "d": {"e": 5}}
    assert merge(dict(base), other) == {"a": {"b": 1, "c": 4}, "d": {"e": 5}}
    assert base == {"a": {"b": 1, "c": 2}, "d": 3}


def test_the_paper_s_campaign_is_the_paper_s():
    config = load_config(str(ROOT / "config" / "paper.yaml"))
    runs = config.experiment
    assert runs.intervals == {"a": Interval(0.99 * 0.035, 0.035, 1.01 * 0.035)}
    assert (runs.design.method, runs.design.order) == ("tensor_roots", 3)
    assert runs.solver.duration == 1.0
    assert config.published == {"BD": 0.063, "vBz": 4.38}


@pytest.mark.parametrize(
    ("other", "published"),
    [
        ({"bounds": {"model": "spline"}}, {"BD": 0.063, "vBz": 4.38}),
        ({"intervals": {"a": {"relative": 0.02}}}, {}),
        ({"intervals": {"a": {"relative": 0.02}}, "published": {"BD": 0.1}}, {"BD": 0.1}),
        ({"scene": {"parameters": {"elements": 4}}}, {}),
    ],
)
def test_what_was_published_of_another_box_is_left_out(other, published):
    assert load_config([ROOT / "config" / "paper.yaml"], other).published == published


def test_where_a_key_stands_is_told_of_each_file_and_of_overrides(tmp_path):
    (tmp_path / "one.yaml").write_text("responses:\n  BD: {distanc: [B, D]}\n", encoding="utf-8")
    with pytest.raises(ConfigError) as error:
        load_config(
            [ROOT / "config" / "paper.yaml", tmp_path / "one.yaml"], {"design": {"order": 0}}
        )
    first, second = error.value.problems
    assert first.startswith("--config: design.order")
    assert second.startswith(f"{tmp_path / 'one.yaml'}, line 2: responses.BD")


@pytest.mark.parametrize(("count", "number"), [(1, 3), (4, 17), (5, 11), (8, 17)])
def test_corners_are_all_corners_or_the_ends_of_all_axes(count, number):
    names = "abcdefgh"[:count]
    found = list(corners({name: Interval(-1.0, 0.25, 1.0) for name in names}))
    assert len(found) == number
    assert found[0] == dict.fromkeys(names, 0.25)
    if count <= 4:
        wanted = [
            dict(zip(names, ends, strict=True)) for ends in product((-1.0, 1.0), repeat=count)
        ]
    else:
        wanted = [{**found[0], name: end} for name in names for end in (-1.0, 1.0)]
    assert all(corner in found[1:] for corner in wanted)
