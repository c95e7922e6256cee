"""YAML: numbers as people write them, keys once, errors with their line."""

from __future__ import annotations

import json
import re

import pytest

from deployable.campaign.config.check import check_config
from deployable.campaign.config.loader import read, restore_types
from deployable.campaign.config.sections import as_json
from deployable.campaign.errors import ConfigError


@pytest.mark.parametrize("text", ["1e9", "1.0e9", "1.e9", "1E9", "1e+9", "1000000000.0"])
def test_numbers_with_exponents_are_numbers(text):
    assert read(f"E: {text}", "x").data == {"E": 1e9}


@pytest.mark.parametrize(("text", "value"), [
    ("010", 10), ("0145", 145), ("0x1F", 31), ("-3", -3), ("1_000", 1000), ("5.", 5.0),
    (".5", 0.5), ("-.inf", -float("inf")),
])  # fmt: skip
def test_numbers_are_those_of_yaml_1_2(text, value):
    assert restore_types({"x": text}) == read(f"x: {text}", "x").data == {"x": value}


@pytest.mark.parametrize("name", ["20261128", "007", "1e3", "1.10", "12:30", "2024-01-02", "~"])
def test_the_name_of_a_campaign_is_what_stands_there(name):
    assert read(f"campaign: {name}", "x").data == restore_types({"campaign": name})
    assert read(f"campaign: {name}", "x").data == {"campaign": name}


@pytest.mark.parametrize("text", ["e9", "1e", "E1", "1e9m", "1:30", "0b11", "0o17"])
def test_text_stays_text(text):
    assert read(f"E: {text}", "x").data == {"E": text}


def test_a_key_given_twice_is_refused_with_both_lines():
    with pytest.raises(ConfigError) as error:
        read("a:\n  b: 1\n  c: 2\n  b: 3\n", "file.yaml")
    assert "file.yaml" in str(error.value)
    assert "line 4: b is defined twice (first on line 2)" in str(error.value)


def test_the_same_key_in_two_mappings_is_fine():
    assert read("a: {x: 1}\nb: {x: 2}", "x").data == {"a": {"x": 1}, "b": {"x": 2}}


@pytest.mark.parametrize("text", ["a: [1, 2", "a: 'b", "a: b: c", "\ta: 1", "a: &x\nb: *y"])
def test_what_is_not_yaml_is_refused_with_its_line(text):
    with pytest.raises(ConfigError, match=r"line \d+: (this is not YAML|\*y stands)"):
        read(text, "x")


@pytest.mark.parametrize("text", ["", "- a", "3", "text"])
def test_a_file_without_keys_is_refused(text):
    with pytest.raises(ConfigError, match="allowed: a mapping"):
        read(text, "x")


def test_keys_are_text():
    assert read("a: 1\n3: x\non: y\n1e3: z", "x").data == {"a": 1, "3": "x", "on": "y", "1e3": "z"}
    with pytest.raises(ConfigError, match="line 2: a key is a mapping or a list"):
        read("a: 1\n[3]: x", "x")


def test_names_have_one_spelling_and_paths_keep_theirs():
    text = "e\u0301: {of: [e\u0301], file: e\u0301}"
    assert read(text, "x").data == {"é": {"of": ["é"], "file": "e\u0301"}}


def test_whole_numbers_and_names_as_programs_write_them():
    plain = {
        "campaign": "test", "scene": {"name": "bennett", "parameters": {"elements": 2}},
        "solver": {"duration": 0.004, "instants": 9}, "intervals": {"a": {"relative": 0.01}},
        "design": {"method": "sobol", "samples": 2000}, "held_out": 2, "jobs": {"group": 2},
        "responses": {"größe": {"distance": ["B", "D"]}},
        "quantities": {"top": {"largest": "größe"}},
        "requirements": {"1": {"top": {"at_most": 1}}},
    }  # fmt: skip
    text = """
campaign: test
scene: {name: bennett, parameters: {elements: 2.0}}
solver: {duration: 4e-3, instants: 9.0}
x-widths: &wide {relative: 1e-2}
.marks: [&few 0.2e1]
intervals: {a: *wide}
design: {method: sobol, samples: 2e3}
held_out: 2.0
jobs: {group: *few}
responses: {gro\u0308ße: {distance: [B, D]}}
quantities: {top: {largest: größe}}
requirements: {1: {top: {at_most: 1}}}
"""
    campaigns = [check_config(raw) for raw in (plain, read(text, "x").data)]
    sections = [
        json.loads(as_json(experiment=c.experiment, requirements=c.requirements)) for c in campaigns
    ]
    assert sections[0] == sections[1]


def test_anchors_stand_for_what_they_mark_and_are_merged():
    text = "a: &x {k: 1, m: [2]}\nb: *x\nc: {<<: *x, k: 3}\nd: {<<: [{k: 4}, *x]}\n"
    data, lines = read(text, "x")
    one = {"k": 1, "m": [2]}
    assert data == {"a": one, "b": one, "c": {**one, "k": 3}, "d": {**one, "k": 4}}
    assert (lines["b.k"], lines["c.k"], lines["c.m"]) == (1, 3, 1)


@pytest.mark.parametrize(
    "text", ["!!int abc", "!!bool abc", "!!timestamp abc", "!!float a", "!a b"]
)
def test_what_a_tag_does_not_fit_is_told(text):
    with pytest.raises(ConfigError, match=r"line 2: (a value cannot be read|this is not YAML)"):
        read(f"b: 1\na: {text}", "x")


def test_text_from_the_command_line_becomes_numbers_again():
    given = {"a": {"b": "0.2", "c": ["1e9", "x"], "d": 3}, "e": "auto", "f": ""}
    wanted = {"a": {"b": 0.2, "c": [1e9, "x"], "d": 3}, "e": "auto", "f": ""}
    assert restore_types(given) == wanted


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("a: !foo {b: 1}", "line 1: the tag '!foo' is not allowed"),
        ("a:\n  - !!python/object:os.system [1]", "line 2: the tag"),
        ('a: "\\U00110000"', "this is not YAML"),
        ("a: !!int 1" + "0" * 5000, "digits"),
    ],
)
def test_what_only_some_readers_take_is_refused(text, words):
    with pytest.raises(ConfigError, match=re.escape(words)):
        read(text, "x")


def test_only_a_plain_key_merges():
    assert read("<<: {a: 1}\nb: 2", "x").data == {"a": 1, "b": 2}
    assert read('"<<": {a: 1}', "x").data == {"<<": {"a": 1}}
    assert read("<<: []\nb: 2", "x").data == {"b": 2}
