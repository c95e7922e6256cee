"""Runs that record responses by their definitions."""

import numpy as np

import fpm


def curves(scene: fpm.Scene, definitions: dict[str, dict], **times):
    """Time (t,) and the values (t,) of responses by name, and the outcome, of one run."""
    found = [fpm.responses.parse(name, d, scene) for name, d in definitions.items()]
    record = [need for response in found for need in response.needs]
    (outcome,) = fpm.simulate(scene, record=record, **times)
    assert outcome.failure is None
    return outcome.time, {r.name: r.evaluate(outcome) for r in found}, outcome


def vectors(kind: str, *names: str) -> dict[str, dict]:
    """Definitions of the components of vectors, "name x" and so on."""
    return {f"{name} {axis}": {kind: name, "component": axis} for name in names for axis in "xyz"}


def vector(found: dict[str, np.ndarray], name: str) -> np.ndarray:
    """The components (t, 3) of a vector among the curves of `vectors`."""
    return np.stack([found[f"{name} {axis}"] for axis in "xyz"], axis=1)
