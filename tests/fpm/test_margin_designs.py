"""Least margins of randomly drawn designs, against evaluations that know nothing of travels: tables
and detents inside the travel, harness, hysteresis, adhesion, motors and loads, on a hinge, on two
that a loop gears, or on a slide; all classes, standards and evidence."""

import os
from itertools import pairwise

import numpy as np
import pytest
from hinged import hinged

import fpm
from fpm.elements import Friction, SyncLoop, TableSpring, TorqueMotor
from fpm.reading import margins, responses
from fpm.reading.quantity_definitions import parse
from fpm.reading.standards import STANDARDS

DESIGNS = int(os.environ.get("DESIGNS", "12"))
"""With 500 they take some twenty minutes of a core."""

RATIO = 2.0


class Design:
    """A scene, and what each part gives (N m, N) where its own opening is psi: `acting`, a list of
    (hinge, class, function)."""

    def __init__(self, seed: int):
        self.rng = rng = np.random.default_rng(seed)
        self.kind = str(rng.choice(["hinge", "geared", "slide"]))
        self.end, self.first = rng.uniform(0.6, 1.6), 0.0
        self.acting, self.points = [], [0.0]
        if self.kind == "slide":
            self.scene = fpm.Scene("slide")
            wall, cart = self.scene.add_particles([(0, 0, 0), (0.3, 0, 0)], 2.0, 1.0)
            self.scene.fix(wall)
            self.scene.add_slide("h1", (wall, cart), (0.3, 0, 0), (1, 0, 0), opening=0.0)
            self.rates = (1.0,)
        else:
            self.rates = (1.0, RATIO)[: 1 + (self.kind == "geared")]
            self.scene = hinged(*[0.0] * len(self.rates))
            if self.kind == "geared":
                self.scene.add(SyncLoop("belt", (0, 1), (0.06, 0.03), 1e11))
        for hinge, rate in enumerate(self.rates):
            self.springs(hinge, rate)
            self.tables(hinge, rate)
            self.hysteresis(hinge, rate)
        self.weight()
        self.motor()
        self.load()
        self.standard = str(rng.choice(list(STANDARDS)))
        self.evidence = str(rng.choice(list(STANDARDS[self.standard].resists)))
        self.more = {}
        if rng.random() < 0.3:
            self.more["output_torque"] = rng.uniform(0.0, 0.05)

    def springs(self, hinge, rate):
        k, psi = self.rng.uniform(0.05, 0.5), self.rng.uniform(0.8, 4.0) * rate
        self.scene.add_torsion_spring(hinge, k, psi)
        self.acting.append((hinge, "S", lambda x: k * (psi - x)))
        f = self.rng.uniform(0.002, 0.03)
        bend = {"bristle_deflection": 1e-4} if self.kind == "slide" else {}
        self.scene.add(Friction(hinge, f, **bend))
        self.acting.append((hinge, "FR", lambda x: -f + 0 * x))

    def table(self, hinge, name, angles, moments):
        self.scene.classes[TableSpring, len(TableSpring.find(self.scene))] = name
        self.scene.add(TableSpring(hinge, tuple(angles), tuple(moments)))
        self.acting.append((hinge, name, lambda x: np.interp(x, angles, moments)))
        self.points += list(np.array(angles) / self.rates[hinge])

    def tables(self, hinge, rate):
        rng = self.rng
        for _ in range(int(rng.integers(0, 3))):
            way = np.sort(rng.uniform(-0.2, 1.2, int(rng.integers(2, 7)))) * self.end * rate
            if np.diff(way).min() > 1e-3:
                name = str(rng.choice(["HA", "S", "HD", "FR"]))
                self.table(hinge, name, way, rng.uniform(-0.05, 0.02, len(way)))
        if rng.random() < 0.6:  # a detent of 0.01 to 1 degrees
            # The belt gives, the evaluation does not know it: no detent is nearly as stiff.
            at, least = rng.uniform(0.05, 0.95) * self.end * rate, -4 + (self.kind == "geared")
            wide = 10 ** rng.uniform(least, -2)
            name, deep = str(rng.choice(["S", "HA"])), -rng.uniform(0.01, 0.2)
            self.table(hinge, name, at + np.array([-wide, 0, wide]), (0.0, deep, 0.0))

    def hysteresis(self, hinge, rate):
        if self.rng.random() < 0.4:
            way = np.linspace(-0.1, 1.1, 5) * self.end * rate
            most, shares = self.rng.uniform(0.002, 0.02), np.append(self.rng.uniform(0, 1, 4), 1.0)
            number = len(Friction.find(self.scene))
            self.scene.classes[Friction, number] = "HY"
            self.scene.add(Friction(hinge, most, angles=tuple(way), shares=tuple(shares)))
            self.acting.append((hinge, "HY", lambda x: -most * np.interp(x, way, shares)))
            self.points += list(way / rate)

    def weight(self):
        size, turn = self.rng.uniform(0, 0.4), self.rng.uniform(0, 2 * np.pi)
        along, across = size * np.cos(turn), size * np.sin(turn)
        if self.kind == "slide":
            self.scene.gravity = (along, across, 0)
            self.acting.append((0, "I", lambda x: 2.0 * along + 0 * x))
        elif self.kind == "hinge":  # 2 kg at 0.5 m
            self.scene.gravity = (along, across, 0)
            self.acting.append((0, "I", lambda x: across * np.cos(x) - along * np.sin(x)))

    def motor(self):
        if self.rng.random() < 0.4:
            torque, curve = self.rng.uniform(-0.05, 0.1), -1
            least = most = 1.0
            if self.rng.random() < 0.5:
                values = self.rng.uniform(-0.2, 1.0, 3)
                self.scene.add_curve([0.0, 0.5, 2.0], values)
                least, most, curve = values.min(), values.max(), len(self.scene.curves) - 1
            self.scene.add(TorqueMotor(0, torque, curve))
            self.acting.append((0, "HM", lambda x: min(torque * least, torque * most) + 0 * x))

    def load(self):
        if self.rng.random() < 0.4 and self.kind == "hinge":
            moment, values = self.rng.uniform(-0.1, 0.1), self.rng.uniform(-1.0, 1.0, 3)
            self.scene.add_curve([0.0, 0.3, 4.0], values)
            curve = len(self.scene.curves) - 1
            self.scene.add_load(1, moment=(0, 0, moment), curve=curve)
            worst = min(moment * values.min(), moment * values.max())
            self.acting.append((0, "TL", lambda x: worst + 0 * x))

    def margin(self, way):
        """The margin (p,) by the sum of what acts."""
        standard = STANDARDS[self.standard]
        resists = standard.resists[self.evidence]
        driving = 0.0
        resisting = resists["TL"] * self.more.get("output_torque", 0.0)
        for hinge, name, gives in self.acting:
            work = self.rates[hinge] * gives(self.rates[hinge] * way)
            driving = driving + standard.drives[name] * np.maximum(work, 0)
            resisting = resisting + resists[name] * np.maximum(-work, 0)
        return driving / np.maximum(resisting, driving / 100) - 1

    def least(self):
        """The least margin, and all places that are as good."""
        points = np.unique(np.clip(self.points, 0, self.end))
        pieces = [np.linspace(a, b, 4001) for a, b in pairwise(points)]
        way = np.unique(np.concatenate([*pieces, np.linspace(0, self.end, 100_001)]))
        margin = self.margin(way)
        i = int(margin.argmin())
        close = np.linspace(way[max(i - 1, 0)], way[min(i + 1, len(way) - 1)], 2001)
        least = min(margin[i], self.margin(close).min())
        return least, way[margin <= least + 1e-7 * (1 + abs(least))]


def off_by(seed: int) -> tuple[float, float]:
    """By how much the least margin of a design is off, as a share of itself (or, next to 0, of
    0.01), and its place, as a share of the travel."""
    design = Design(seed)
    definition = {"margin": "h1", "to": float(design.end), "standard": design.standard,
                  "evidence": design.evidence, **design.more}  # fmt: skip
    response = responses.parse("m", definition, design.scene)
    run = margins.sweep_travel(design.scene, [response])
    asked = {"least": {"smallest": "m"}, "at": {"smallest_at": "m"}}
    least, at = (number.evaluate(run) for number in parse(asked, [response], [])[0])
    assert least >= -1.0
    exact, places = design.least()
    budget = margins.make_torque_budget(response, run)
    weighted = np.array([row.weighted for row in budget.rows])
    assert budget.margin == least and budget.opening == at
    assert weighted[weighted > 0].sum() == pytest.approx(budget.drives, abs=1e-15)
    assert -weighted[weighted < 0].sum() == pytest.approx(budget.requirement, abs=1e-15)
    return abs(least - exact) / max(abs(exact), 0.01), np.abs(places - at).min() / design.end


@pytest.mark.parametrize("seed", range(DESIGNS))
def test_drawn_designs(seed):
    value, place = off_by(seed)
    assert value <= 1e-3, seed
    assert place <= 1e-3, seed
