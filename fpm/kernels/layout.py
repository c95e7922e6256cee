"""Where each quantity stands along the middle axis of the kernels' arrays (rows, fields, lanes).

Fields of one kind's own arrays are named beside its kernels."""

WIDTH = 8
"""Samples that are simulated side by side, in the lanes of a register."""

# State of a particle.
X = 0  # position (3)
D2 = 3  # directors: the particle's second and third axis in global components (3 each); the first
D3 = 6  # is their product
V = 9  # velocity (3), half a step behind the position
P = 12  # angular momentum in global components (3), half a step behind
F = 15  # force (3)
M = 18  # moment (3)
STATE = 21
START_FIELDS = 15  # fields that recording needs from the start of a step: X, D2, D3, V, P

# Constants of a particle. The inverses are zero where a particle is held.
IM = 0  # inverse mass
IJ = 1  # inverse principal inertias (3)
MASS = 4  # mass, for gravity and damping
KICK = 5  # velocity that a force gives in this step's kick: time of the kick by inverse mass
HALF = 6  # half the turn that an angular momentum gives in a step: 0.5 step J^-1 (3)
BY_SPIN = 9  # 1 where a drive moves it: its angular velocity stands for the angular momentum
PARTICLE = 10

# A recorded point at an instant.
POSITION, VELOCITY = 0, 3  # (3 each)
POINT = 6

# Recorded energies at an instant, then what each account has had and what each kind has stored.
KINETIC, BALANCE, ACCOUNTS = 0, 1, 2

# Sums of energies from which the balance is found.
TOTAL = 0  # at t = 0: stored, less what was given, and what was taken
ENERGY_SIZE = 1  # sizes of what is stored now, with a little of the kick, or of what passed
SUPPLY = 2  # by all that gives, at the last check
PASSAGE = 3  # largest change of that since
SUMS = 4
