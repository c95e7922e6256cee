"""Configs that once raised, hung or filled memory: refused at once with key, value and what is
allowed, in the words of a user."""

from __future__ import annotations

import resource
import time

import pytest

from deployable.campaign.config.check import load_config
from deployable.campaign.errors import ConfigError

GOOD = """\
campaign: mine
scene: {name: bennett, parameters: {elements: 2}}
solver: {duration: 0.01, instants: 21}
intervals:
  a: {nominal: 0.035, relative: 0.01}
responses:
  BD: {distance: [B, D]}
"""
EIGHT = "".join(f"  {name}: {{relative: 0.01}}\n" for name in
                ("a", "L", "E", "rho", "K_C", "K_F", "start", "roll"))  # fmt: skip
BOMB = "a0: &a0 [x, x, x, x, x, x, x, x, x]\n" + "".join(
    f"a{i}: &a{i} [{', '.join([f'*a{i - 1}'] * 9)}]\n" for i in range(1, 9)
)


def changed(old: str, new: str) -> str:
    assert old in GOOD
    return GOOD.replace(old, new)


def solver(text: str) -> str:
    return changed("{duration: 0.01, instants: 21}", f"{{{text}}}")


CASES = {
    "control characters": (changed("mine", "mi\x07ne"), ["line 1", r"'\x07'"]),
    "an integer of 400 digits": (solver("duration: " + 400 * "9"), ["solver.duration", "number"]),
    "deep nesting": (changed("mine", 3000 * "[" + 3000 * "]"), ["nested too deep", "20"]),
    "recursive nesting": (changed("mine", "&a [*a]"), ["line 1: *a stands for what &a marks"]),
    "an alias bomb": (BOMB + GOOD, ["20000 values", "fewer"]),
    "Smolyak 8 in eight directions": (
        changed("  a: {nominal: 0.035, relative: 0.01}\n", EIGHT)
        + "design: {method: smolyak, order: 8}\n",
        ["design.order", "53089 polynomials", "10000"],
    ),
    "a hundred million elements": (
        changed("elements: 2", "elements: 100000000"),
        ["scene.parameters.elements", "100000000", "to 1000"],
    ),
    "no time at all": (solver("duration: 5.0e-324"), ["solver.duration", "5e-324", "1e-9"]),
    "too many steps": (solver("duration: 1.0e+6"), ["solver.duration", "steps", "at most 1e+09"]),
    "a step far above the limit": (
        solver("duration: 1.0, instants: 11, step: 0.01"), ["solver.step", "0.01 s", "auto"],
    ),
    "too many instants for memory": (solver("instants: 1000000"), ["solver.instants", "memory"]),
    "a campaign's long name": (changed("mine", 300 * "m"), ["campaign", "64 letters"]),
    "a response that ends in a newline": (changed("  BD:", '  "BD\\n":'), ["responses.BD"]),
    "an interval of a in mm": (
        changed("nominal: 0.035", "nominal: 35"), ["intervals.a", "lower end, 34.65", "to 10 (m)"],
    ),
}  # fmt: skip


@pytest.mark.parametrize("case", CASES)
def test_it_is_refused_at_once_in_words(tmp_path, case):
    text, words = CASES[case]
    path = tmp_path / "bad.yaml"
    path.write_text(text, encoding="utf-8")
    before, start = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss, time.process_time()
    with pytest.raises(ConfigError) as refused:
        load_config([path])
    assert time.process_time() - start < 2.0
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 2**20  # kB: 1 GiB
    for word in words:
        assert word in str(refused.value)
    assert len(str(refused.value)) < 5000


def test_the_good_one_is_good_and_dates_are_text(tmp_path):
    path = tmp_path / "good.yaml"
    path.write_text(changed("mine", "2020-02-30"), encoding="utf-8")
    assert load_config([path]).name == "2020-02-30"


SCISSOR = """\
campaign: mast
scene: {file: scissor.yaml, parameters: {n: 2, elements: 2}}
solver: {duration: 0.01, instants: 5}
intervals: {k: {relative: 0.05}}
responses: {psi: {opening: HINGE}}
"""


def test_responses_are_those_of_the_structure_as_it_is_built(tmp_path, request):
    from fpm import structures

    file = request.config.rootpath / "config" / "structures" / "scissor.yaml"
    (tmp_path / "scissor.yaml").write_text(file.read_text(encoding="utf-8"), encoding="utf-8")
    known = structures.load(file)
    three, two = known.hinges, {h.name for h in known.build(n=2).hinges}
    last = next(name for name in three if name not in two)
    path = tmp_path / "mast.yaml"
    path.write_text(SCISSOR.replace("HINGE", last), encoding="utf-8")
    with pytest.raises(ConfigError, match=r"responses\.psi"):
        load_config([path])
    path.write_text(SCISSOR.replace("HINGE", min(two)), encoding="utf-8")
    assert load_config([path]).experiment.response_list[0].subjects == (min(two),)
    path.write_text(SCISSOR.replace("HINGE", last).replace("n: 2", "n: 3"), encoding="utf-8")
    assert load_config([path]).experiment.response_list[0].subjects == (last,)
