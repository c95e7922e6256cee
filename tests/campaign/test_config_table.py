"""The reference of config keys, and the schemas for editors, follow the declarations."""

from __future__ import annotations

import io
import json
import sys
from contextlib import redirect_stdout
from functools import cache
from pathlib import Path

import jsonschema
import pytest
import yaml

from deployable.campaign.cli import main
from deployable.campaign.config.read import whole
from fpm.structures.statements import GROUPS, STATEMENTS

ROOT = Path(__file__).parents[2]
sys.path.append(str(ROOT / "docs/extensions"))

from key_tables import keys_page, rows  # noqa: E402


def test_every_key_of_every_statement_is_in_the_reference():
    sections = keys_page().split("\n## ")
    for statement in STATEMENTS:
        text = next(one for one in sections if statement.text in one)
        assert all(f"| `{name}`" in text for name in statement.keys)


def test_every_key_says_what_it_is_and_what_is_allowed():
    for key, about, allowed, _ in rows(whole()):
        assert about.endswith((".", ")")) and allowed, key


@cache
def validator(of):
    done = io.StringIO()
    with redirect_stdout(done):
        assert main(["schema", of]) == 0
    schema = json.loads(done.getvalue())
    jsonschema.Draft202012Validator.check_schema(schema)
    return jsonschema.Draft202012Validator(schema)


CONFIGS = ROOT / "config"
SHIPPED = [("campaign", path) for path in sorted(CONFIGS.glob("*.yaml"))]
SHIPPED += [("structure", path) for path in sorted((CONFIGS / "structures").glob("*.yaml"))]


@pytest.mark.parametrize(("of", "path"), SHIPPED, ids=lambda x: getattr(x, "stem", x))
def test_what_we_ship_is_as_the_schemas_have_it(of, path):
    validator(of).validate(yaml.safe_load(path.read_text("utf-8")))


def test_values_of_a_list_are_not_counted_as_its_length():
    raw = yaml.safe_load((CONFIGS / "small.yaml").read_text("utf-8"))
    validator("campaign").validate(raw | {"design": {"values": [0.045, 0.05]}})
    with pytest.raises(jsonschema.ValidationError):
        validator("campaign").validate(raw | {"design": {"values": []}})


@pytest.mark.parametrize(("of", "place", "value"), [
    ("campaign", ("solver", "durations"), 1),
    ("campaign", ("solver", "duration"), -1),
    ("campaign", ("solver", "instants"), 2.5),
    ("campaign", ("jobs", "keep"), True),
    ("campaign", ("intervals",), {}),
    ("campaign", ("intervals", "k", "relative"), -0.1),
    ("campaign", ("choose",), {"parameters": {"k": [1]}}),
    ("campaign", ("quantities", "1st"), {"final": "psi"}),
    ("campaign", ("responses", "psi"), {"opening": "A", "component": "x"}),
    ("campaign", ("margins", "root"), {"along": "A", "to": "90 deg"}),
    ("structure", ("actions", "damper"), {"type": "damper", "joint": "root"}),
    ("structure", ("actions", "damper"), {"joint": "root", "damping": 1}),
    ("structure", ("actions", "latch"), {"type": "latch", "joint": "root", "angle": 1, "side": 1}),
    ("structure", ("start",), "at rest"),
    ("structure", ("parameters", "k"), {"valu": 1}),
    ("structure", ("gravity",), [0, 0]),
])  # fmt: skip
def test_the_schemas_refuse_what_is_wrong(of, place, value):
    name = "deploys.yaml" if of == "campaign" else "structures/solar_array.yaml"
    data = yaml.safe_load((CONFIGS / name).read_text("utf-8"))
    validator(of).validate(data)
    table = data
    for key in place[:-1]:
        table = table.setdefault(key, {})
    table[place[-1]] = value
    with pytest.raises(jsonschema.ValidationError):
        validator(of).validate(data)


def test_the_schemas_know_every_key():
    for row in rows(whole()):
        part = validator("campaign").schema
        for name in row[0].split("."):
            parts = [part, *part.get("anyOf", [])]
            (table,) = (one for one in parts if "properties" in one)
            part = table["properties"].get(name) or table["additionalProperties"]
    groups = validator("structure").schema["properties"]
    assert {*GROUPS} < {*groups}
