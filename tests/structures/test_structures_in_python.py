"""Structures stated in Python are those of the same text, and the texts written from them are."""

import pickle
import random

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from structures_for_tests import FOLDER, FOURBAR, SMALL, content

import fpm
from evidence.attack.metamorphic.random_structures import Draw
from evidence.attack.metamorphic.structure_text import as_text, map_numbers
from fpm.structures import StructureError, load, loads
from fpm.structures.statements import GROUPS
from fpm.structures.structure import _singular

SHIPPED = sorted([*FOLDER.glob("*.yaml"), *FOLDER.parent.glob("measured/arm.yaml")])


def stated(table: dict) -> fpm.Structure:
    """The structure of a file's mapping, each entry by the method of its group."""
    groups = ("parameters", "let", "points", "repeat", *GROUPS)
    result = fpm.Structure(**{key: value for key, value in table.items() if key not in groups})
    state(result, table)
    for name, keys in table.get("repeat", {}).items():
        texts = {key: value for key, value in keys.items() if not isinstance(value, dict)}
        state(result.repeat(name, **texts), keys)
    return result


def state(statements, table: dict) -> None:
    for name, keys in table.get("parameters", {}).items():
        statements.parameter(name, **keys)
    for name, value in table.get("let", {}).items():
        statements.let(name, value)
    for name, value in table.get("points", {}).items():
        statements.point(name, value)
    for group in GROUPS:
        for name, keys in table.get(group, {}).items():
            getattr(statements, _singular(group))(name, **keys)


@pytest.mark.parametrize("path", SHIPPED, ids=lambda path: path.stem)
def test_shipped_structures_come_back_from_methods_and_text(path, tmp_path):
    expected, structure = load(path), fpm.Structure.read(path)
    structure.write(tmp_path / path.name)
    assert load(tmp_path / path.name).digest == structure.scene_type.digest == expected.digest
    scene = content(expected.build())
    assert content(stated(structure.table).build()) == scene
    name, parameter = next((n, p) for n, p in expected.parameters.items() if not p.is_whole)
    value = parameter.default * 0.99 + 2e-3
    other = content(structure.build(**{name: value}))
    assert other == content(expected.build(**{name: value})) != scene


def test_random_structures_are_those_of_their_text():
    count = 0
    for seed in range(12):
        table = Draw(random.Random(seed)).draw()
        try:
            expected = content(loads(as_text(table)).build())
        except StructureError:
            continue
        count += 1
        structure = stated(map_numbers(table, lambda x, unit: f"{x} rad" if unit == "rad" else x))
        assert content(structure.build()) == content(loads(structure.text()).build()) == expected
    assert count > 6


def test_groups_have_the_methods_of_their_words():
    assert {_singular(group) for group in GROUPS} >= {"body", "mass", "initial_velocity", "load"}
    assert "revolute: " in fpm.Structure.joint.__doc__
    assert all(getattr(fpm.Structure, _singular(group)).__doc__ for group in GROUPS)


def flap(**overall) -> fpm.Structure:
    s = fpm.Structure("flap", "A flap", **overall)
    s.parameter("L", 1, "m", range=(0.1, np.float64(10)))
    s.parameter("n", np.int64(1), whole=True)
    s.point("root", np.zeros(3))
    s.point("ti\u0301p", ["L", 0, 0.0])
    inertia = [np.float32(0.5), 0.1 + 0.2, 0.25]
    s.body("panel", mass=2, centre="típ", points=["root"], inertia=inertia)
    s.joint("hinge", type="revolute", parts=["ground", "panel"], at="root", axis=(0, -1, 0))
    s.action("spring", type="torsion spring", joint="hinge", stiffness="n*0.2 N m", rest="90 deg",
             class_=None)  # fmt: skip
    return s


def test_numbers_are_kept_to_the_last_bit():
    scene = flap(gravity=np.array([0, 0, -9.81]), damping=None).build(L=1 / 3)
    assert scene.springs[0].stiffness == 0.2
    assert scene.inertia[scene.mass == 2].tolist() == [[0.5, 0.1 + 0.2, 0.25]]
    assert scene.position[:, 0].max() == 1 / 3


def test_what_is_wrong_is_told_by_key_all_at_once():
    assert "<pre>empty has 1 problem" in fpm.Structure("empty")._repr_html_()
    s = flap()
    s.joint("hung", type="revolute", parts=["ground", "pannel"], at="root", axis="up")
    s.action("tight", type="damper", joint="hinge", damping=-1, dampin=2, class_="FR")
    with pytest.raises(StructureError, match="flap has 4 problems") as caught:
        s.build()
    assert "line" not in str(caught.value)
    for words in (
        "joints.hung.axis: 'up'",
        "'pannel' (did you mean panel?)",
        "actions.tight.dampin",
    ):
        assert words in str(caught.value)


@pytest.mark.parametrize(("name", "value", "words"), [
    ("spring", {}, "actions.spring is defined twice"),
    ("odd", {"stiffness": object()}, "actions.odd.stiffness"),
    ("odd", {"rest": [None]}, "actions.odd.rest"),
])  # fmt: skip
def test_names_twice_and_values_of_no_text_are_refused_at_once(name, value, words):
    with pytest.raises(fpm.SceneError, match=words):
        flap().action(name, **value)


@settings(max_examples=12, deadline=None)
@given(text=st.text(st.characters(codec="utf-8", exclude_categories=("Cc", "Zl", "Zp", "Cs"))))
def test_any_text_comes_back_from_what_is_written(text):
    s = fpm.Structure("any", description=text)
    s.parameter("x", 1, description=text)
    again = fpm.structures.reading.read(s.text(), fpm.structures.reading.Problems("any"))
    assert again.plain == s.table


def test_a_structure_crosses_processes_and_is_made_anew_when_changed():
    s = pickle.loads(pickle.dumps(stated(load_table(FOURBAR))))
    first = s.scene_type
    assert s.scene_type is first
    s.load("push", part="BC", at="end", force=[1, 0, 0])
    assert len(s.build().loads) == 1
    assert s.scene_type.digest != first.digest == loads(FOURBAR).digest


def load_table(text: str) -> dict:
    return fpm.structures.reading.read(text, fpm.structures.reading.Problems("text")).plain


def test_curves_are_those_of_the_folder(tmp_path):
    (tmp_path / "push.csv").write_text("t [s],F [N]\n0,0\n1,2\n")
    (tmp_path / "other").mkdir()
    (tmp_path / "other" / "push.csv").write_text("t [s],F [N]\n0,0\n1,3\n")
    text = SMALL + "curves:\n  push: {file: push.csv, column: F}\nloads:\n" \
                   "  pull: {part: arm, at: B, force: [1 N, 0, 0], curve: push}\n"  # fmt: skip
    (tmp_path / "a.yaml").write_text(text.replace("[1 N, 0, 0]", "[1, 0, 0]"))
    s = fpm.Structure.read(tmp_path / "a.yaml")
    s.write(tmp_path / "b.yaml")
    assert load(tmp_path / "b.yaml").digest == load(tmp_path / "a.yaml").digest
    with pytest.raises(StructureError, match="the folder of the structure"):
        s.write(tmp_path / "other" / "b.yaml")
