"""Responses: scalar functions of time that are read off a trajectory."""

from dataclasses import dataclass

import numpy as np

from fpm.elements import Latch, RigidLatch
from fpm.elements.openings.latch import RECORDED
from fpm.elements.openings.opening import SLIDING
from fpm.errors import SceneError
from fpm.files.outcome import Outcome
from fpm.files.variables import Column
from fpm.reading import asked_responses
from fpm.scenes.scene_type import SceneType

_NEVER_NEGATIVE = ("strain", "spring", "contact")  # energies: sums of squares
LATCH = tuple(RECORDED)
ALWAYS = ("distance", "position", "velocity", "opening", "tension", "energy", *LATCH)
"""The kinds of responses that every run records."""

COMPONENTS = ("x", "y", "z", "norm")


@dataclass(frozen=True)
class Response:
    """A named response: `kind`, what it is about (points, a hinge, ...), `component` of a vector.

    unit (UDUNITS) and long_name are those of the values that `evaluate` returns. needs: columns
    that a run must record for it (fpm.files.variables), beside what is always recorded.
    """

    name: str
    kind: str
    about: tuple[str, ...]
    component: str
    unit: str
    long_name: str
    needs: tuple[Column, ...] = ()

    @property
    def least(self) -> float | None:
        """The least value that it can have; None where there is none.

        The kinetic energy is a product of velocities half a step apart (`fpm.kernels.record`),
        which can differ in sign.
        """
        size = self.kind in ("distance", "tension", "stress") or self.component == "norm"
        stored = self.kind == "energy" and self.about[0] in _NEVER_NEGATIVE
        return 0.0 if size or stored else None

    def evaluate(self, outcome: Outcome) -> np.ndarray:
        """Values (t,) of the response for one outcome; KeyError if it did not record its needs."""
        if self.kind in asked_responses.KINDS:
            return asked_responses.evaluate(
                self.kind, self.about, self.component, self.needs, outcome
            )
        if self.kind == "distance":
            first, second = (outcome.points[p][0] for p in self.about)
            return np.linalg.norm(first - second, axis=1)
        if self.kind in ("position", "velocity"):
            track = outcome.points[self.about[0]][self.kind == "velocity"]
            if self.component == "norm":
                return np.linalg.norm(track, axis=1)
            return track[:, COMPONENTS.index(self.component)]
        if self.kind == "opening":
            return outcome.openings[self.about[0]]
        if self.kind == "tension":
            return outcome.tensions[self.about[0]]
        if self.kind in LATCH:
            return outcome.latches[self.about]
        if self.kind == "energy":
            return outcome.energies[self.about[0]]
        raise ValueError(f"{self.name}: nothing is read off a run for the kind {self.kind}")


def _one_of(key: str, value: object, known: tuple[str, ...]) -> str:
    if value not in known:
        raise SceneError(key, value, f"one of {', '.join(known) or '(this scene has none)'}")
    return value


def parse(name: str, definition: dict, scene_type: SceneType) -> Response:
    """A response from its definition in a config; SceneError names what is wrong.

    One of: {distance: [P, Q]}, {position: P, component: z}, {velocity: P, component: z},
    {opening: H}, {tension: C}, {energy: kind}, {latch_impulse: L} and the others of LATCH; points
    P, Q, hinges H, cables C, kinds and latches L as the scene has them; or one of
    `asked_responses.KINDS`, which docs/responses.md describes.
    """
    kinds = (*ALWAYS, *asked_responses.KINDS)
    if not isinstance(definition, dict) or len(set(definition) & set(kinds)) != 1:
        raise SceneError(f"responses.{name}", definition, f"exactly one of {', '.join(kinds)}")
    kind = next(k for k in kinds if k in definition)
    if kind in asked_responses.KINDS:
        found = asked_responses.read(name, kind, definition, scene_type.sample)
        return Response(name, kind, *found)
    value, key = definition[kind], f"responses.{name}.{kind}"
    others = set(definition) - {kind, "component"}
    if others or ("component" in definition) != (kind in ("position", "velocity")):
        raise SceneError(
            f"responses.{name}", definition,
            f"{kind}" + (" and component" if kind in ("position", "velocity") else " alone"),
        )  # fmt: skip
    if kind == "distance":
        if not isinstance(value, list | tuple) or len(value) != 2 or value[0] == value[1]:
            raise SceneError(key, value, "two different points")
        points = tuple(_one_of(key, p, scene_type.points) for p in value)
        text = f"distance between {points[0]} and {points[1]}"
        return Response(name, kind, points, "", "m", text)
    if kind in ("position", "velocity"):
        point = _one_of(key, value, scene_type.points)
        component = definition["component"]
        component = _one_of(f"responses.{name}.component", component, COMPONENTS)
        unit = "m" if kind == "position" else "m s-1"
        what = "magnitude of the " if component == "norm" else f"{component}-component of the "
        return Response(name, kind, (point,), component, unit, f"{what}{kind} of {point}")
    if kind == "opening":
        hinge = _one_of(key, value, scene_type.hinges)
        if any(h.slides for h in scene_type.sample.hinges if h.name == hinge):
            return Response(name, kind, (hinge,), "", "m", f"opening of slide {hinge}")
        return Response(name, kind, (hinge,), "", "rad", f"opening of hinge {hinge}")
    if kind == "tension":
        cable = _one_of(key, value, scene_type.cables)
        return Response(name, kind, (cable,), "", "N", f"tension of cable {cable}")
    if kind in LATCH:
        return _of_latch(name, kind, key, value, scene_type.sample)
    energy = _one_of(key, value, scene_type.energies)
    return Response(name, kind, (energy,), "", "J", f"{energy} energy")


def _of_latch(name: str, kind: str, key: str, value: object, scene) -> Response:
    """A response of a latch; impacts are those of latches that hold exactly."""
    kinds = (RigidLatch,) if kind == "latch_impact" else (Latch, RigidLatch)
    latches = {latch.label(scene): latch for k in kinds for latch in k.of(scene)}
    on = [label for label, x in latches.items() if scene.hinges[x.hinge].name == value]
    label = on[0] if len(on) == 1 and value not in latches else _one_of(key, value, tuple(latches))
    slides = scene.hinges[latches[label].hinge].slides
    unit, _, _, text = RECORDED[kind]
    unit = SLIDING[unit] if slides else unit
    about = (f"slide_{kind.replace('moment', 'force')}" if slides else kind, label)
    return Response(name, kind, about, "", unit, f"{text} of latch {label}")
