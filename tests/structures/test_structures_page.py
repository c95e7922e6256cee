"""Every example of docs/structures.md is right."""

import re
from pathlib import Path

import pytest
import yaml
from structures_for_tests import problems_of

from fpm.structures import loads

PAGE = (Path(__file__).parents[2] / "docs" / "structures.md").read_text()
BLOCKS = re.findall(r"^```(\w*)\n(.*?)^```", PAGE, re.M | re.S)
YAML = [text for language, text in BLOCKS if language == "yaml"]
PYTHON = [text for language, text in BLOCKS if language == "python"]


def merged(base, more):
    """A mapping with what another one changes or adds."""
    out = dict(base)
    for key, value in more.items():
        nested = isinstance(value, dict) and key in ("parameters", "points", "bars", "joints",
                                                     "sections")  # fmt: skip
        out[key] = {**base.get(key, {}), **value} if nested else value
    return out


def test_the_page_has_examples():
    assert len(YAML) >= 15 and len(PYTHON) >= 2


@pytest.mark.parametrize("text", YAML, ids=[text.split(":")[0] for text in YAML])
def test_examples_are_structures_alone_or_as_additions_to_the_first(text):
    data = yaml.load(text, yaml.BaseLoader)
    if "name" not in data:
        data = merged(yaml.load(YAML[0], yaml.BaseLoader), data)
        text = yaml.safe_dump(data, sort_keys=False)
    found = loads(text)
    assert found.name == data["name"]
    assert set(found.parameters) == set(data.get("parameters", {}))
    found.build()


def test_the_first_example_in_python_runs(monkeypatch):
    monkeypatch.chdir(Path(__file__).parents[2])
    space: dict = {}
    exec(PYTHON[0], space)
    assert space["scene"].springs[0].stiffness == 0.2


def test_the_messages_of_the_page_are_those_of_the_program():
    (shown,) = [text for language, text in BLOCKS if not language]
    wrong = YAML[0].replace("section: strip", "section: strop").replace("axis: -y", "axis: up")
    assert [line.strip() for line in shown.splitlines()[1:]] == problems_of(wrong)


@pytest.mark.parametrize("what", ["L + 0.1", "90", "stow*L*1 N"])
def test_what_the_page_says_is_refused_is(what):
    key = "rest: 90 deg" if what == "90" else "width: 200 mm"
    assert problems_of(YAML[0].replace(key, f"{key.split()[0]} {what}"))
