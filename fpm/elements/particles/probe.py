"""What is recorded of a run on request (reading/variables.py says for what).

A scene without a probe has a time loop without it. With one, the loop keeps at every instant the
frames of some particles; of some of them momenta, forces and how the momenta change in the step
around the instant; the moments on openings, told apart by who acts; and the impulses of joints."""

from dataclasses import dataclass

from fpm.elements.kind import ElementType


@dataclass(frozen=True)
class Probe(ElementType):
    """What else a run of a scene records, as its responses need it. frames: indices of particles
    whose positions and axes are recorded; forces: indices of those, also in `frames`, whose
    velocities, angular momenta and forces are; moments: whether moments on hinges are, by component
    (springs, dampers, ...); impulses: whether the constraint impulses of joints are."""

    frames: tuple[int, ...] = ()
    forces: tuple[int, ...] = ()
    moments: bool = False
    impulses: bool = False

    cost = 0.0

    @staticmethod
    def of_scene(scene) -> "Probe":
        """Return the Probe of a scene, or one that records nothing where it has none."""
        return next(iter(Probe.find(scene)), Probe())

    @classmethod
    def reads_impulses(cls, scene):
        return cls.of_scene(scene).impulses

    def topology(self):
        return self.frames, self.forces, self.moments, self.impulses

    @classmethod
    def pack(cls, batch):
        from fpm.elements.particles.probe_kernels import FORCES, FRAME, Probes

        probe, rows = cls.of_scene(batch.scene), batch.instants + 1
        return Probes(
            frames_of=batch.integers(probe.frames),
            forces_of=batch.integers(probe.forces),
            frames=batch.blank(rows * len(probe.frames), FRAME),
            forces=batch.blank(rows * len(probe.forces), FORCES),
        )
