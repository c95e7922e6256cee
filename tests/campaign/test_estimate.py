"""The time that is foretold of the shipped campaigns is what they take."""

from __future__ import annotations

import time
from pathlib import Path

import pytest

import fpm
from deployable.campaign.answers.estimate import describe_work, estimate
from deployable.campaign.config.check import check_config
from deployable.campaign.plan.jobs import LANES, run_seconds
from deployable.campaign.plan.plan import choose_step
from fpm.files.trajectory import read_curves
from fpm.scenes.timestep import machine

CONFIG = Path(__file__).parents[2] / "config"
UNLIKE = "paper", "deploys", "hatch", "mast", "ring_truss", "telescope", "tensegrity", "winch"
"""Shipped campaigns of which no two have the same kinds of element; others are like one of them."""

RIGHT = 2.0
"""Factor within which an idle core has to take what is foretold."""

BUSY = 2.5
"""By how much others on the machine slow down a core that runs here, at most, in the best of many
bursts. Once 1.5; but on a shared host the same steps took 5.8 ms in one process and 12.2 in the
next, each from its first burst to its last."""


def loaded(name: str):
    return check_config(CONFIG / f"{name}.yaml")


@pytest.mark.parametrize("name", UNLIKE)
@pytest.mark.slow
def test_the_time_foretold_is_what_is_taken(name):
    """The first part of a batch of a campaign, the best of several."""
    experiment = loaded(name).experiment
    step, solver = choose_step(experiment), experiment.solver
    nominal = dict(zip(experiment.box.names, experiment.nominal, strict=True))
    scenes = [experiment.build(nominal)] * LANES
    foretold = LANES * machine() * run_seconds(experiment, step)
    part = min(1.0, 0.2 / foretold)  # of a second, some
    instants = max(2, round(part * (solver.instants - 1)) + 1)
    duration = solver.duration * (instants - 1) / (solver.instants - 1)

    def seconds() -> float:
        begun = time.process_time()
        (first, *_) = fpm.simulate(scenes, duration=duration, instants=instants, step=step.step)
        assert first.failure is None
        return time.process_time() - begun

    seconds()  # compiles
    taken = min(seconds() for _ in range(5))
    steps = step.output_steps * (instants - 1)
    expected = LANES * machine() * _of(experiment, steps, instants)
    assert expected / RIGHT < taken < RIGHT * BUSY * expected


@pytest.mark.slow
@pytest.mark.parametrize("name", ["latch", "deploys"])
def test_the_price_of_a_campaign_is_what_all_of_it_takes(name, shipped):
    """By processor time, as others may be busy beside it; of the last a half is the choice."""
    found = estimate(loaded(name))
    _, taken = shipped(name)
    assert found.seconds / RIGHT < taken < RIGHT * BUSY * found.seconds


def _of(experiment, steps: int, instants: int) -> float:
    from fpm.scenes import timestep

    nominal = dict(zip(experiment.box.names, experiment.nominal, strict=True))
    return timestep.run_seconds(experiment.build(nominal), steps, instants)


def test_joints_that_share_bodies_are_in_the_time_of_a_campaign():
    """24 of them: 20 s where registers hold 256 bits, of which 0.8 were foretold."""
    found = estimate(loaded("ring_truss"))
    assert 10 < found.core_time / machine() < 40
    assert found.seconds > found.core_time / 2


def test_runs_that_answers_take_are_foretold():
    plain, asked = estimate(loaded("mast")), estimate(loaded("closing"))
    assert plain.answers == "" and "further" not in str(plain)
    assert asked.answers == "quantities and the choice"
    assert "further ones for quantities and the choice" in str(asked)


@pytest.mark.slow
def test_the_ends_of_a_time_are_in_order_and_a_choice_is_in_it(raw):
    from deployable import campaign

    del raw["design"], raw["held_out"]
    adaptive = {"accuracy": {"tolerance": 0.05, "max_core_minutes": 0.001}}
    short = estimate(campaign.check_config(raw | adaptive))
    assert short.seconds <= short.ceiling
    asks = {"accuracy": 0.05, "quantities": {"most": {"largest": "BD"}}}
    usual = estimate(campaign.check_config(raw | asks))
    asks |= {"choose": {"parameters": {"a": [0.034, 0.036]}, "minimise": ["upper(most)"]}}
    chosen = estimate(campaign.check_config(raw | asks))
    assert chosen.core_time > usual.core_time and chosen.seconds > usual.seconds + 3


def test_a_finer_mesh_and_step_cost_more_than_the_runs(raw):
    from deployable import campaign

    stages = "plan", "simulate", "bounds", "answers"
    usual = estimate(campaign.check_config(raw), stages)
    raw["verify"] = {"discretization": True}
    finer = estimate(campaign.check_config(raw), stages)
    assert finer.core_time == pytest.approx(12 * usual.core_time)  # 1, 2 + 4 and 4 + 1
    assert finer.runs == usual.runs


def test_margins_cost_their_travels_and_a_cache_saves_compiling(monkeypatch):
    """Travels take far longer than the integration of the runs here."""
    from deployable.campaign.answers import estimate as module

    whole = estimate(loaded("review"))
    monkeypatch.setattr(module, "TRAVEL", 0.0)
    monkeypatch.setattr("fpm.list_kinds_to_compile", lambda *rest: [])
    plain = estimate(loaded("review"))
    assert whole.core_time > 20 * plain.core_time and plain.compile_time == 0.0
    assert whole.seconds > plain.seconds + whole.compile_time + 20 * plain.core_time


def test_an_accuracy_has_a_likely_time_below_its_ceiling():
    found = estimate(loaded("aim"))
    assert 5 < found.seconds < found.ceiling / 2
    assert ", at most 30 min" in str(found)


@pytest.mark.slow
def test_a_campaign_that_is_finished_has_nothing_to_be_done_or_what_is_left(raw, tmp_path):
    from deployable import campaign
    from deployable.campaign.stages.workflow import Workflow

    config = campaign.check_config(raw)
    assert "of them" not in describe_work(Workflow(config, tmp_path))
    campaign.run(config, tmp_path, figures=False, notify=str)
    assert "nothing to be done" in describe_work(Workflow(config, tmp_path), figures=False)
    left = describe_work(Workflow(config, tmp_path))
    assert "about" in left and "of them are there" in left
    assert estimate(config, ["figures", "page"], 0.0).seconds < estimate(config).seconds
    first, *rest = (tmp_path / "test/trajectories").glob("*.nc")
    first.unlink()
    assert f"; {sum(len(read_curves(path)) for path in rest)} of them are there" in describe_work(
        Workflow(config, tmp_path), figures=False
    )
    raw["solver"]["duration"] *= 2
    other = describe_work(Workflow(campaign.check_config(raw), tmp_path))
    assert f"{tmp_path / 'test'} holds is of another config or version, and is replaced" in other
