"""What coupled joints cost, against hinges that are solved alone: the same pairs, and chains."""

import numpy as np

import fpm
from evidence.benchmark.clock import best

PAIRS = 50
LANES = 8


def pairs(is_coupled: bool) -> fpm.Scene:
    """Free pairs of turning rigid bodies; is_coupled: their hinges are joints of the one system."""
    scene = fpm.Scene("pairs")
    for k in range(PAIRS):
        x = 3.0 * k
        places = [(x - 0.5, 0, 0), (x + 0.5, 0, 0)]
        spin = np.array([[0.0, 1.0, 0.0], [0.0, -1.0, 0.0]])
        velocity = [(0, 0, -0.5), (0, 0, -0.5)]
        pair = scene.add_particles(places, 1.0, 0.1, velocity=velocity, spin=spin)
        if is_coupled:
            scene.add_joint(f"pin {k}", "revolute", pair, (x, 0, 0), (0, 1, 0))
        else:
            scene.add_hinge(f"pin {k}", pair, (x, 0, 0), (0, 1, 0))
    return scene


def chain(bodies: int) -> fpm.Scene:
    """A free chain of rigid bodies, its middle moving."""
    scene = fpm.Scene("chain")
    places = [(float(k), 0, 0) for k in range(bodies)]
    particles = scene.add_particles(places, 1.0, 0.1)
    for k in range(bodies - 1):
        scene.add_hinge(f"pin {k}", particles[k : k + 2], (k + 0.5, 0, 0), (0, 1, 0))
    scene.velocity[bodies // 2] = (0, 0, 0.1)
    return scene


def measure(steps: int = 5000, repeats: int = 3) -> dict[str, float]:
    """Seconds of cpu a step, joint and sample, by case."""
    cases = {
        "hinges alone": pairs(is_coupled=False),
        "the same as joints": pairs(is_coupled=True),
        "a chain of 51 bodies": chain(PAIRS + 1),
        "a chain of 501 bodies": chain(10 * PAIRS + 1),
    }
    joints = {name: len(s.hinges) or PAIRS for name, s in cases.items()}
    runs = {}
    for name, scene in cases.items():
        count = steps * PAIRS // joints[name]
        runs[name, True], runs[name, False] = _runner(scene, count), _runner(scene, count // 10)
        runs[name, False]()  # compiles, or loads, the time loop
    seconds = best(runs, repeats)
    samples = 0.9 * steps * PAIRS * LANES
    return {name: (seconds[name, True] - seconds[name, False]) / samples for name in cases}


def _runner(scene: fpm.Scene, steps: int):
    def run() -> None:
        fpm.simulate([scene] * LANES, duration=1e-4 * steps, instants=2, step=1e-4)

    return run
