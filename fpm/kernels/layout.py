"""Where each quantity stands along the middle axis of the kernels' arrays (rows, fields, lanes)."""

# State of a particle.
X = 0  # position (3)
D2 = 3  # directors: the particle's second and third axis in global components (3 each); the first
D3 = 6  # is their product
V = 9  # velocity (3), half a step behind the position
P = 12  # angular momentum in global components (3), half a step behind
F = 15  # force (3)
M = 18  # moment (3)
STATE = 21
KEPT = 15  # fields that recording needs from the start of a step: X, D2, D3, V, P

# Constants of a particle. The inverses are zero where a particle is held.
IM = 0  # inverse mass
IJ = 1  # inverse principal inertias (3)
MASS = 4  # mass, for gravity and damping
PARTICLE = 5

# Constants of a beam element.
LENGTH = 0  # undeformed length
AXIAL = 1  # EA/l0
BEND_Z = 2  # 2 EIz/l0
BEND_Y = 3  # 2 EIy/l0
TWIST = 4  # GJ/l0
BEAM = 5
# Axes of an element in the frames of its particles, where they differ from these: 2, 3 at a and b.
AXES = 12

CHORD = 5  # working fields of an element: chord (3), inverse length, axial force

# Constants of a body of a hinge; vectors in the particle's frame.
ARM = 0  # virtual beam (3)
AXIS = 3  # axis (3)
REF = 6  # reference direction (3)
HIM = 9  # inverse masses along the global axes (3)
HIJ = 12  # inverse principal inertias (3)
BODY = 15

# Constants of a hinge.
HELD = 0  # 1 where the hinge point is held along a global axis (3)
PLACE = 3  # where it is held (3)
HINGE = 6

BODY_SCRATCH, HINGE_SCRATCH = 30, 72  # working fields, named in hinge_matrix.py

# Largest values so far: square of the sine of an element's bend, strain at an element's surface,
# gap of a hinge's point (m) and of its axes (rad).
LARGEST_BEND, LARGEST_STRAIN, LARGEST_GAP, LARGEST_TILT = range(4)

# Energies.
KINETIC, STRAIN, SPRING, CONTACT, LOAD_WORK, DAMPING_WORK, BALANCE = range(7)
ENERGIES = ("kinetic", "strain", "spring", "contact", "load_work", "damping_work", "balance")
