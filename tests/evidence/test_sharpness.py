"""The suite's tolerances are sharp: with a wrong number in an element, rows fail."""

from dataclasses import replace

import numpy as np
import pytest

import fpm
from evidence.verification.bench import Bench
from evidence.verification.study import PARTS
from fpm.elements.bars import lumping
from fpm.elements.bars.beam import Beams

pytestmark = pytest.mark.slow  # problems with time loops of their own


def failing_rows(name: str) -> int:
    """Number of failing rows of a problem; a run that breaks down counts as one."""
    return sum(row.is_failed for row in PARTS[name](True).rows)


# Columns of Beams.stiffness: length, EA, 2 EIz, 2 EIy, GJ over the length.
@pytest.mark.parametrize(
    ("column", "factor", "name"),
    [
        (1, 1.02, "spin-up"),
        (1, 1.03, "frequencies"),
        (2, 1.01, "small tip load"),
        (3, 1.01, "small tip load"),
        (3, 1.02, "Princeton beam"),
        (4, 1.05, "45° bend"),
        (4, 1.03, "frequencies"),
    ],
)
def test_a_wrong_stiffness_fails(monkeypatch, column, factor, name):
    right = Beams.stiffness

    def wrong(self):
        table = right(self)
        table[:, column] *= factor
        return table

    monkeypatch.setattr(Beams, "stiffness", wrong)
    assert failing_rows(name) > 0


def test_half_and_half_lumping_fails(monkeypatch):
    """Half of each element's mass at either end lowers the frequencies of a free bar by 3 %."""

    def trapezium(length, elements, section, material, scale=1.0):
        mass, inertia = lumping.lump(length, elements, section, material, scale)
        mass = np.full(elements + 1, mass.sum() / elements)
        mass[[0, -1]] /= 2
        return mass, inertia

    monkeypatch.setattr("fpm.scenes.scene.lump", trapezium)
    assert failing_rows("frequencies") > 0


@pytest.mark.parametrize(
    ("method", "name"),
    [("add_torsion_spring", "spring oscillator"), ("add_contact", "contact bounce")],
)
def test_a_wrong_joint_fails(monkeypatch, method, name):
    right = getattr(fpm.Scene, method)
    monkeypatch.setattr(
        fpm.Scene, method, lambda self, h, k, **options: right(self, h, 1.005 * k, **options)
    )
    assert failing_rows(name) > 0


def test_isotropic_inertia_loses_the_flips(monkeypatch):
    right = Bench.simulate

    def round_body(self, scenes, **options):
        scenes.inertia = np.full_like(scenes.inertia, scenes.inertia.mean())
        return right(self, scenes, **options)

    monkeypatch.setattr(Bench, "simulate", round_body)
    assert failing_rows("tumbling body") > 0


def test_a_drift_of_momentum_fails(monkeypatch):
    """A force of 1e-9 of the weight on a free body shows."""
    right = Bench.simulate

    def pushed(self, scene, **options):
        scene.gravity = np.array([0, 0, 1e-9])
        return right(self, scene, **options)

    monkeypatch.setattr(Bench, "simulate", pushed)
    assert failing_rows("free bodies") > 0


def test_a_sloppy_pivot_fails(monkeypatch):
    """An arm of the load that is 0.5 % too long changes the precession of the top."""
    right = fpm.Scene.add_load

    def longer(self, *args, **options):
        right(self, *args, **options)
        load = self.loads[-1]
        self.loads[-1] = replace(load, beam=replace(load.beam, arm=1.005 * load.beam.arm))

    monkeypatch.setattr(fpm.Scene, "add_load", longer)
    assert failing_rows("heavy top") > 0
