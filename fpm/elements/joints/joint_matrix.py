"""The matrix A = G M^-1 G^T of coupled joints: how impulses change the rates of all their gaps.

Theory: docs/mechanics.md, "Joints that are solved together". It is factorised by Cholesky's method
in the order of `Pattern`. Its diagonal is raised by a share of 1e-10, for redundant
conditions; a condition on which no impulse can act gets none."""

from fpm.elements.joints.joint_arrays import AXIS_IM, DIRECTION, IMPULSE, PIVOT, ROOT1
from fpm.kernels.lanes import load, sqrt, store, where_negative
from fpm.kernels.vectors import dot, get3, kernel, larger, times


@kernel
def build(part):
    """Build the matrix A of all joints (rates of gaps by unit impulses; lower blocks, diagonal
    raised by the share part.ease), and store its own diagonal in PIVOT of part.rows."""
    pattern, rows, matrix = part.pattern, part.rows, part.matrix
    for e in range(matrix.shape[0]):
        store(matrix, e, 0, 0.0)
    for n in range(pattern.meets.shape[0]):
        k, j = pattern.meets[n, 0], pattern.meets[n, 1]
        s1, s2 = pattern.meets[n, 2], pattern.meets[n, 3]
        inverse_mass = get3(part.bodies, part.slots[2 * k + s1], AXIS_IM)
        sign = 1.0 if s1 == s2 else -1.0
        index = pattern.meets[n, 4]
        for r in range(pattern.first[k], pattern.first[k] + pattern.count[k]):
            shift = sign * times(inverse_mass, get3(rows, r, DIRECTION))
            turn = sign * get3(rows, r, ROOT1 + 3 * s1)
            for c in range(pattern.first[j], pattern.first[j] + pattern.count[j]):
                entry = dot(shift, get3(rows, c, DIRECTION))
                entry = entry + dot(turn, get3(rows, c, ROOT1 + 3 * s2))
                store(matrix, index, 0, load(matrix, index, 0) + entry)
                index += 1
    for j in range(pattern.count.shape[0]):
        size, index = pattern.count[j], pattern.diagonal[j]
        for r in range(size):
            entry = load(matrix, index + r * size + r, 0)
            store(rows, pattern.first[j] + r, PIVOT, entry)
            store(matrix, index + r * size + r, 0, entry + part.ease * entry)


@kernel
def factorise(part):
    """Replace the matrix in part.matrix, as `build` left it, by its Cholesky factor, and PIVOT of
    part.rows by the inverse of the factor's diagonal. part: arrays of all joints (Joints)."""
    pattern, rows, matrix = part.pattern, part.rows, part.matrix
    for j in range(pattern.count.shape[0]):
        first, size, start = pattern.first[j], pattern.count[j], pattern.diagonal[j]
        for c in range(size):
            for r in range(c, size):
                entry = load(matrix, start + r * size + c, 0)
                for m in range(c):
                    factor = load(matrix, start + r * size + m, 0)
                    entry = entry - factor * load(matrix, start + c * size + m, 0)
                if r == c:
                    diagonal = load(rows, first + c, PIVOT)
                    entry = larger(entry, part.ease * diagonal)
                    pivot = where_negative(-1.0 * diagonal, 1.0 / sqrt(entry), 0.0)
                    store(rows, first + c, PIVOT, pivot)
                    entry = pivot * entry
                else:
                    entry = load(rows, first + c, PIVOT) * entry
                store(matrix, start + r * size + c, 0, entry)
        for n in range(pattern.below_start[j], pattern.below_start[j + 1]):
            block, height = pattern.followers[n, 1], pattern.count[pattern.followers[n, 0]]
            for r in range(height):
                for c in range(size):
                    entry = load(matrix, block + r * size + c, 0)
                    for m in range(c):
                        factor = load(matrix, block + r * size + m, 0)
                        entry = entry - factor * load(matrix, start + c * size + m, 0)
                    pivot = load(rows, first + c, PIVOT)
                    store(matrix, block + r * size + c, 0, pivot * entry)
        for n in range(pattern.update_start[j], pattern.update_start[j + 1]):
            i, k = pattern.updates[n, 0], pattern.updates[n, 1]
            lhs, rhs = pattern.updates[n, 2], pattern.updates[n, 3]
            target, width = pattern.updates[n, 4], pattern.count[k]
            for r in range(pattern.count[i]):
                for c in range(width):
                    entry = load(matrix, target + r * width + c, 0)
                    for m in range(size):
                        factor = load(matrix, lhs + r * size + m, 0)
                        entry = entry - factor * load(matrix, rhs + c * size + m, 0)
                    store(matrix, target + r * width + c, 0, entry)


@kernel
def substitute(part):
    """Solve for the impulses: replace the right side in IMPULSE of part.rows (changes of gap rates,
    m/s, rad/s) by A^-1 times it (N s, N m s). part: all joints (Joints), after `factorise`."""
    pattern, rows, matrix = part.pattern, part.rows, part.matrix
    count = pattern.count.shape[0]
    for j in range(count):
        first, size, start = pattern.first[j], pattern.count[j], pattern.diagonal[j]
        for c in range(size):
            x = load(rows, first + c, IMPULSE)
            for m in range(c):
                x = x - load(matrix, start + c * size + m, 0) * load(rows, first + m, IMPULSE)
            store(rows, first + c, IMPULSE, load(rows, first + c, PIVOT) * x)
        for n in range(pattern.below_start[j], pattern.below_start[j + 1]):
            k, block = pattern.followers[n, 0], pattern.followers[n, 1]
            for r in range(pattern.count[k]):
                x = load(rows, pattern.first[k] + r, IMPULSE)
                for m in range(size):
                    x = x - load(matrix, block + r * size + m, 0) * load(rows, first + m, IMPULSE)
                store(rows, pattern.first[k] + r, IMPULSE, x)
    for count_down in range(count):
        j = count - 1 - count_down
        first, size, start = pattern.first[j], pattern.count[j], pattern.diagonal[j]
        for n in range(pattern.below_start[j], pattern.below_start[j + 1]):
            k, block = pattern.followers[n, 0], pattern.followers[n, 1]
            for m in range(pattern.count[k]):
                x = load(rows, pattern.first[k] + m, IMPULSE)
                for c in range(size):
                    y = load(rows, first + c, IMPULSE)
                    entry = load(matrix, block + m * size + c, 0)
                    store(rows, first + c, IMPULSE, y - entry * x)
        for b in range(size):
            c = size - 1 - b
            x = load(rows, first + c, IMPULSE)
            for m in range(c + 1, size):
                x = x - load(matrix, start + m * size + c, 0) * load(rows, first + m, IMPULSE)
            store(rows, first + c, IMPULSE, load(rows, first + c, PIVOT) * x)
