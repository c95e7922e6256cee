"""What a config may name is what the program has, by its registries."""

from __future__ import annotations

import re
from dataclasses import fields
from pathlib import Path
from typing import get_args, get_type_hints

import pytest

from deployable.campaign.config.check import check_config
from deployable.campaign.config.models import BoundsChoice, DesignSection, Jobs
from deployable.campaign.errors import ConfigError
from deployable.campaign.runs.store import STORES
from deployable.intervals import METHODS, MODELS
from evidence.registry import STUDIES
from fpm.reading import quantities, responses

DOCS = Path(__file__).parents[2] / "docs"


def words(section, key):
    """The words that a key may have."""
    return set(get_args(get_type_hints(section)[key]))


def test_every_design_can_be_asked_for_with_all_its_options_and_no_other():
    assert words(DesignSection, "method") == set(METHODS)
    options = {option for method in METHODS.values() for option in method.options}
    options -= {"seed"}  # of Python alone
    assert {field.name for field in fields(DesignSection)} == {
        "method",
        "order",
        "file",
        "values",
    } | options


def test_every_model_can_be_asked_for_and_no_other():
    """What has no surrogate has its samples' extremes, whatever is asked for."""
    assert words(BoundsChoice, "model") == set(MODELS) - {"scan"}


def test_every_store_can_be_asked_for_and_no_other():
    assert words(Jobs, "keep") == set(STORES)


@pytest.mark.parametrize("name", STUDIES)
def test_no_campaign_has_the_name_of_a_study(raw, name):
    """The results of both are in `results/`."""
    with pytest.raises(ConfigError, match=f"campaign: '{name}' is not allowed"):
        check_config({**raw, "campaign": name})


@pytest.mark.parametrize(
    ("page", "known"),
    [
        ("responses.md", set(responses.KINDS)),
        ("quantities.md", set(quantities.KINDS)),
    ],
)
def test_every_kind_of_a_definition_is_in_its_table_and_no_other(page, known):
    text = (DOCS / page).read_text(encoding="utf-8")
    table = re.findall(r"^\| (`\{\w+: [^|]*) \|", text, re.MULTILINE)
    assert {kind for row in table for kind in re.findall(r"`\{(\w+): ", row)} == known


def test_definitions_of_quantities_show_all_their_keys():
    text = (DOCS / "quantities.md").read_text(encoding="utf-8")
    rows = re.findall(r"^\| (`\{\w+: [^|]*) \|", text, re.MULTILINE)
    shown = [re.findall(r"(\w+): ", each) for row in rows for each in re.findall("`{(.*?)}`", row)]
    assert {kind: set(keys) for kind, *keys in shown} == {
        kind: {*known.mandatory, *known.optional} for kind, known in quantities.KINDS.items()
    }
