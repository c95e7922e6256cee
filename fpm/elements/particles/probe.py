"""What is recorded of a run on request (reading/variables.py says for what).

A scene without a probe has a time loop without it. With one, the loop keeps at every instant the
frames of some particles; of some of them momenta, forces and how the momenta change in the step
around the instant; the moments on openings, told apart by who acts; and the impulses of joints.
"""

from dataclasses import dataclass

from fpm.elements.kind import ElementType


@dataclass(frozen=True)
class Probe(ElementType):
    """What is recorded of a scene's run on request. frames: indices of particles whose positions
    and axes are recorded; forces: of those, also in `frames`, whose momenta and forces are;
    moments: whether moments on openings are; impulses: whether those of joints."""

    frames: tuple[int, ...] = ()
    forces: tuple[int, ...] = ()
    moments: bool = False
    impulses: bool = False

    cost = 0.0

    @staticmethod
    def of_scene(scene) -> "Probe":
        """The probe of a scene (what is recorded on request), or one that records nothing."""
        return next(iter(Probe.of(scene)), Probe())

    @classmethod
    def reads_impulses(cls, scene):
        return cls.of_scene(scene).impulses

    def topology(self):
        """What must be equal in scenes whose samples run side by side: all fields of the probe."""
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
