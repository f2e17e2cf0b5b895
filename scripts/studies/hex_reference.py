#!/usr/bin/python3
"""An explicit finite element program of its own for the impact sample: nothing of it is shared with igasolve.

  scripts/studies/hex_reference.py 12 -o hex12.npz                 foam cube of 12 x 12 x 12 hexahedra under the sphere
  scripts/studies/hex_reference.py 6 --rate polar --friction 0     another objective rate, no friction
  scripts/studies/hex_reference.py 12 --one-point                  one point per element and hourglass stiffness

Method (kg, mm, ms, kN, GPa)
  Elements    trilinear hexahedra, 2 x 2 x 2 Gauss points (or one, with the stiffness of Flanagan & Belytschko 1981 against
              hourglassing), row-sum mass; f = sum_g w P(F) grad N over the undeformed block, P = J sigma F^-T.
  Time        central differences; dt = safety * dt_0 * min(sigma_min(F) / sqrt(J), 1), dt_0 from the largest eigenvalue
              of one element. Internal energy by the trapezoidal rule over each step.
  Foam        crushable foam without interaction of the directions, *MAT_063 MODEL 0 of the LS-DYNA theory manual: the elastic
              trial stress turns with the body and grows by C : d; its principal values are clipped to -Y(1 - J) … tension limit.
              Turning: `jaumann` by Hughes & Winget 1980, midpoint; `polar` by R of F = R U (Green & Naghdi).
  Contact     every surface quadrilateral carries midpoints of a raster (4 mm or finer, at least 2 x 2); each presses with
              penalty * area * depth on the sphere or the plane and holds on by a spring as stiff, which slides at friction *
              normal force. penalty = scale * E / h. The sphere moves and spins freely. No self-contact, no damping at all.
Energies are in J, impulses in Ns; `velocity` is the sphere's along z, `depth` that of the contact points in it.
"""
import argparse
import time as clock

import numpy as np
from scipy import sparse

SIDE, RADIUS, CENTRE, SPEED, MASS, INERTIA, END = 100.0, 35.0, (50.0, 50.0, 136.0), 8.0, 1.0, 490.0, 8.0
EXTENSIVE = ("force", "impulse", "internal", "kinetic", "contact", "friction")
SERIES = ("time", *EXTENSIVE, "velocity", "depth", "least_volume")
CURVE = np.array([(0, 3e-4), (0.4, 3.5e-4), (0.6, 6e-4), (0.7, 1.2e-3), (0.8, 4e-3), (0.9, 0.02), (0.95, 0.05)])
CHUNK = 128  # elements worked on at a time, so that their arrays stay in the cache
CORNERS = np.array([(i, j, k) for k in (0, 1) for j in (0, 1) for i in (0, 1)])


# Tensors are arrays (3, 3, n), symmetric or not; n numbers the points.

def product(a, b):
    return a[:, 0, None] * b[None, 0] + a[:, 1, None] * b[None, 1] + a[:, 2, None] * b[None, 2]


def transposed(a):
    return a.transpose(1, 0, 2)


def cross(a, b):
    return np.stack([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])


def determinant(a):
    return (a[0] * cross(a[1], a[2])).sum(0)


def inverse(a):
    rows = np.stack([cross(a[1], a[2]), cross(a[2], a[0]), cross(a[0], a[1])], axis=1)
    return rows / (a[0] * rows[:, 0]).sum(0)


def add_diagonal(a, value):
    for d in range(3):
        a[d, d] += value
    return a


def principal_values(s):
    """Eigenvalues (3, n), descending, of symmetric tensors, by the cosine formula."""
    mean = np.trace(s) / 3
    rest = add_diagonal(s.copy(), -mean)
    size = np.sqrt((rest * rest).sum((0, 1)) / 6) + 1e-300
    angle = np.arccos(np.clip(determinant(rest / size) / 2, -1, 1)) / 3
    first, last = mean + 2 * size * np.cos(angle), mean + 2 * size * np.cos(angle + 2 * np.pi / 3)
    return np.stack([first, 3 * mean - first - last, last])


def clip_principal(s, low, high):
    """Principal values of symmetric tensors clipped to low … high (n), directions kept: Newton's interpolation in s."""
    value = principal_values(s)
    clipped = np.clip(value, low, high)

    def slope(above, below, numerator):
        gap = value[above] - value[below]
        return np.where(gap > 1e-14, numerator / np.maximum(gap, 1e-14), 0)
    upper = slope(0, 1, clipped[0] - clipped[1])
    bend = slope(0, 2, upper - slope(1, 2, clipped[1] - clipped[2]))
    shifted = add_diagonal(s.copy(), -value[0])
    result = upper * shifted + bend * product(shifted, add_diagonal(s.copy(), -value[1]))
    return add_diagonal(result, clipped[0])


def rotation(f):
    """R of F = R U."""
    left, _, right = np.linalg.svd(np.moveaxis(f, 2, 0))
    return np.moveaxis(left @ right, 0, 2)


class Foam:
    def __init__(self, modulus=0.05, poisson=0.0, density=6e-8, curve=CURVE, tension=3e-4, rate="jaumann"):
        self.modulus, self.density, self.curve, self.tension, self.rate = modulus, density, np.asarray(curve), tension, rate
        self.shear = modulus / (2 * (1 + poisson))
        self.bulk = modulus * poisson / ((1 + poisson) * (1 - 2 * poisson))  # Lamé's first constant

    def yield_stress(self, strain):
        """Y at a volumetric strain 1 - J; beyond the curve with its last slope."""
        strain, (x, y) = np.maximum(strain, 0), self.curve.T
        last = (y[-1] - y[-2]) / (x[-1] - x[-2])
        return np.interp(strain, x, y) + last * np.maximum(strain - x[-1], 0)

    def update(self, stress, old, change, volume):
        """Stress kept (3, 3, n) and Cauchy stress after F went from old to old + change, where det F is `volume`. With
        `polar` what is kept is R^T sigma R."""
        middle = old + change / 2
        gradient = product(change, inverse(middle))
        strain = (gradient + transposed(gradient)) / 2
        if self.rate == "polar":
            turn = rotation(middle)
            strain, trial = product(transposed(turn), product(strain, turn)), stress
        else:
            spin = (gradient - transposed(gradient)) / 2
            turn = spin + product(spin, spin) / 2
            turn = add_diagonal(turn / (1 + (spin * spin).sum((0, 1)) / 8), 1.0)
            trial = product(turn, product(stress, transposed(turn)))
        trial = add_diagonal(trial + 2 * self.shear * strain, self.bulk * np.trace(strain))
        limit = self.yield_stress(1 - volume)
        beyond = np.flatnonzero((trial * trial).sum((0, 1)) > np.minimum(limit, self.tension) ** 2)
        if beyond.size:
            trial[:, :, beyond] = clip_principal(trial[:, :, beyond], -limit[beyond], self.tension)
        if self.rate != "polar":
            return trial, trial
        turn = rotation(old + change)
        return trial, product(turn, product(trial, transposed(turn)))


class Block:
    """Box size (3) from the origin in divisions (3) hexahedra; positions and velocities of its nodes (nodes, 3). `mirrored`:
    its faces x = size and y = size are planes of symmetry, without contact."""

    def __init__(self, size, divisions, law, one_point=False, hourglass=0.05, mirrored=False):
        size, divisions = np.asarray(size, float), np.asarray(divisions)
        self.law, self.step, self.divisions = law, size / divisions, divisions
        across = divisions + 1
        index = np.indices(across).reshape(3, -1).T
        self.start = index * self.step
        number = np.ravel_multi_index(index.T, across).reshape(across)
        cells = np.indices(divisions).reshape(3, -1).T
        self.elements = number[tuple(np.moveaxis(cells[:, None] + CORNERS[None], 2, 0))].T.copy()  # (8, elements)
        faces = [(axis, end) for axis in range(3) for end in (0, -1) if not (mirrored and axis < 2 and end)]
        nodes = [np.take(number, end, axis) for axis, end in faces]
        self.quads = np.concatenate([
            np.stack([n[:-1, :-1], n[1:, :-1], n[:-1, 1:], n[1:, 1:]], 2).reshape(-1, 4) for n in nodes])
        self.quad_areas = np.concatenate([
            np.full((n.shape[0] - 1) * (n.shape[1] - 1), np.prod(np.delete(self.step, axis)))
            for n, (axis, _) in zip(nodes, faces)])
        self.free = np.ones_like(self.start)  # factors of the velocity
        if mirrored:
            self.free[:, :2] = self.start[:, :2] < size[:2] - self.step[:2] / 2
        sides = 2 * CORNERS - 1
        places = np.zeros((1, 3)) if one_point else sides / np.sqrt(3)
        factors = 1 + places[:, None] * sides[None]
        # table (3 J, points, 8): d N_a / d X_J
        table = [sides[:, j] / 4 / self.step[j] * np.prod(np.delete(factors, j, axis=2), axis=2) for j in range(3)]
        self.points = len(places)
        self.weight = np.prod(self.step) / self.points
        self.table = np.reshape(table, (3 * self.points, 8))
        self.mass = np.bincount(self.elements.ravel(), minlength=len(self.start)) * law.density * np.prod(self.step) / 8
        modes = np.stack([sides[:, 0] * sides[:, 1], sides[:, 1] * sides[:, 2], sides[:, 2] * sides[:, 0], sides.prod(1)])
        share = hourglass * law.modulus * np.prod(self.step) * (self.table**2).sum() / 8 if one_point else 0.0
        self.hourglass = share * modes.T @ modes / 8
        count = self.elements.shape[1]
        self.chunks = [np.arange(first, min(first + CHUNK, count)) for first in range(0, count, CHUNK)]
        self.state = [(np.repeat(np.eye(3)[:, :, None], self.points * len(c), 2),
                       np.zeros((3, 3, self.points * len(c)))) for c in self.chunks]
        self.position, self.velocity = self.start.copy(), np.zeros_like(self.start)
        self.first_step, self.squeeze, self.least_volume = self.critical_step(), 1.0, 1.0

    def critical_step(self):
        gradients = self.table.reshape(3, self.points, 8)
        normal = np.einsum("jga,kgb->ajbk", gradients, gradients)  # d_ij terms of lambda and mu
        swap = normal.transpose(0, 3, 2, 1)
        same = np.einsum("jga,jgb->ab", gradients, gradients)[:, None, :, None] * np.eye(3)[None, :, None, :]
        stiffness = self.weight * (self.law.bulk * normal + self.law.shear * (swap + same))
        stiffness += self.hourglass[:, None, :, None] * np.eye(3)[None, :, None, :]
        largest = np.linalg.eigvalsh(stiffness.reshape(24, 24))[-1] / (self.law.density * np.prod(self.step) / 8)
        return 2 / np.sqrt(largest)

    def forces(self, moved):
        """Internal forces (nodes, 3) after a displacement `moved` since the last call; `squeeze` is the factor of the
        critical step, min sigma_min(F) / sqrt(J) over the points."""
        every = np.empty((3, 8, self.elements.shape[1]))
        least, volume_least = 1.0, np.inf
        for number, chunk in enumerate(self.chunks):
            nodes = self.elements[:, chunk]
            old, stress = self.state[number]
            change = (self.table @ np.moveaxis(moved[nodes], 2, 0)).reshape(3, 3, -1)
            new = old + change
            volume = determinant(new)
            if volume.min() <= 0:
                raise ArithmeticError(f"det F is {volume.min():.3g}: an element turned inside out")
            kept, cauchy = self.law.update(stress, old, change, volume)
            self.state[number] = new, kept
            back = inverse(new)
            first = product(cauchy, transposed(back)) * (volume * self.weight)
            every[:, :, chunk] = self.table.T @ first.reshape(3, -1, len(chunk))
            if self.hourglass.any():
                shift = np.moveaxis((self.position - self.start)[nodes], 2, 0)
                every[:, :, chunk] += self.hourglass @ shift
            largest = principal_values(product(back, transposed(back)))[0] * volume
            least, volume_least = min(least, largest.max()**-0.5), min(volume_least, volume.min())
        self.squeeze, self.least_volume = least, volume_least
        return np.stack([np.bincount(self.elements.ravel(), every[d].ravel(), len(self.start)) for d in range(3)], 1)


class Rigid:
    """A sphere (radius) or the plane through `centre` with normal z; it moves where it has a mass."""

    def __init__(self, centre, radius=None, mass=np.inf, inertia=np.inf, velocity=(0, 0, 0), free=(1, 1, 1)):
        self.centre, self.velocity, self.spin = np.array(centre, float), np.array(velocity, float), np.zeros(3)
        self.radius, self.mass, self.inertia, self.free = radius, mass, inertia, np.array(free)

    def gap(self, x):
        """Distance (n) of points outside it and outward normals (n, 3)."""
        if self.radius is None:
            return x[:, 2] - self.centre[2], np.broadcast_to(np.array([0, 0, 1.0]), x.shape)
        away = x - self.centre
        length = np.linalg.norm(away, axis=1)
        return length - self.radius, away / length[:, None]

    def kinetic(self):
        pairs = ((self.mass, self.velocity), (self.inertia, self.spin))
        return sum(mass * motion @ motion / 2 for mass, motion in pairs if motion.any())


class Contact:
    def __init__(self, block, rigid, friction, stiffness, spacing=4.0):
        """Pressure = stiffness (force / length³) * depth at raster points of the surface."""
        raster = max(2, int(np.ceil(block.step.max() / spacing - 1e-9)))
        t = (np.arange(raster) + 0.5) / raster
        u, v = (a.ravel() for a in np.meshgrid(t, t, indexing="ij"))
        shape = np.stack([(1 - u) * (1 - v), u * (1 - v), (1 - u) * v, u * v], 1)
        points = len(block.quads) * len(shape)
        columns = np.repeat(block.quads[:, None], len(shape), axis=1).reshape(points, 4)
        values = np.tile(shape, (len(block.quads), 1))
        self.weights = sparse.csr_matrix((values.ravel(), columns.ravel(), np.arange(points + 1) * 4),
                                         (points, len(block.start)))
        self.spread = self.weights.T.tocsr()
        self.spring = stiffness * np.repeat(block.quad_areas, len(shape)) / len(shape)
        self.rigid, self.friction, self.drag = rigid, friction, np.zeros((points, 3))
        self.force, self.energy, self.slid, self.depth = np.zeros(3), 0.0, 0.0, 0.0

    def forces(self, position, moved, dt):
        """Forces on the nodes (nodes, 3) after they and the rigid body moved in a step; the body's are kept in `force`
        and `torque`."""
        x = self.weights @ position
        gap, normal = self.rigid.gap(x)
        touching = np.flatnonzero(gap < 0)
        normal, arm = normal[touching], x[touching] - self.rigid.centre
        spring, pressing = self.spring[touching], -gap[touching] * self.spring[touching]
        carried = dt * (self.rigid.velocity + np.cross(self.rigid.spin, arm))
        shift = self.weights[touching] @ moved - carried
        drag = self.drag[touching] - spring[:, None] * shift
        drag -= normal * (drag * normal).sum(1)[:, None]
        size, most = np.linalg.norm(drag, axis=1), self.friction * pressing
        held = drag * np.minimum(1, most / np.maximum(size, 1e-300))[:, None]
        self.slid += (np.linalg.norm(held, axis=1) * np.maximum(size - most, 0) / spring).sum()
        self.energy = 0.5 * ((pressing**2 + (held**2).sum(1)) / spring).sum()
        self.depth = -gap.min(initial=0)
        self.drag[:] = 0
        self.drag[touching] = held
        force = pressing[:, None] * normal + held
        self.force, self.torque = -force.sum(0), -np.cross(arm, force).sum(0)
        every = np.zeros_like(x)
        every[touching] = force
        return self.spread @ every


def simulate(block, contacts, end, safety=0.8, tell=0):
    """Series (see SERIES) over all steps until `end`; the first contact's force is recorded, its body moves."""
    moved, dt, time, internal, impulse = np.zeros_like(block.start), 0.0, 0.0, 0.0, 0.0
    rows, earlier, began = [], np.zeros_like(block.start), clock.process_time()
    while True:
        inner = block.forces(moved)
        internal += 0.5 * ((inner + earlier) * moved).sum()
        earlier = inner
        total = sum(c.forces(block.position, moved, dt) for c in contacts) - inner
        dt_next = min(safety * block.first_step * block.squeeze, end - time)
        span = (dt + dt_next) / 2
        acceleration = total / block.mass[:, None]
        before = block.velocity
        block.velocity = (before + span * acceleration) * block.free
        kinetic = 0.5 * (block.mass[:, None] * before * block.velocity).sum()
        for contact in contacts:
            body = contact.rigid
            kinetic += body.kinetic() / 2
            body.velocity = body.velocity + span * body.free * contact.force / body.mass
            body.spin = body.spin + span * contact.torque / body.inertia
            kinetic += body.kinetic() / 2
        impulse += span * contacts[0].force[2]
        rows.append((time, contacts[0].force[2], impulse, internal, kinetic, sum(c.energy for c in contacts),
                     sum(c.slid for c in contacts), contacts[0].rigid.velocity[2], contacts[0].depth, block.least_volume))
        if tell and len(rows) % tell == 0:
            print(f"  dt {dt_next:.2e}", *(f"{name} {value:.4f}" for name, value in zip(SERIES, rows[-1])),
                  f"{clock.process_time() - began:.0f} s", flush=True)
        if time >= end * (1 - 1e-12):
            return dict(zip(SERIES, np.array(rows).T))
        moved, dt = dt_next * block.velocity, dt_next
        block.position = block.position + moved
        for contact in contacts:
            contact.rigid.centre = contact.rigid.centre + dt * contact.rigid.velocity
        time += dt


def impact(divisions, rate="jaumann", one_point=False, hourglass=0.05, friction=0.2, penalty=1.0, spacing=4.0, end=END,
           safety=0.8, tell=0, quarter=False):
    """The impact sample on divisions³ hexahedra, or on a quarter of them between the planes of symmetry."""
    law, share = Foam(rate=rate), 4 if quarter else 1
    across = np.array([2, 2, 1] if quarter else [1, 1, 1])
    block = Block(SIDE / across, divisions // across, law, one_point, hourglass, quarter)
    stiffness = penalty * law.modulus / block.step[0]
    inertia, free = (np.inf, (0, 0, 1)) if quarter else (INERTIA, (1, 1, 1))
    sphere = Rigid(CENTRE, RADIUS, MASS / share, inertia, (0, 0, -SPEED), free)
    contacts = [Contact(block, body, friction, stiffness, spacing) for body in (sphere, Rigid((0, 0, 0)))]
    series = simulate(block, contacts, end, safety, tell)
    return {name: values * (share if name in EXTENSIVE else 1) for name, values in series.items()}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("divisions", type=int, help="elements along an edge of the cube")
    parser.add_argument("--rate", choices=("jaumann", "polar"), default="jaumann", help="how the stress turns")
    parser.add_argument("--one-point", action="store_true")
    parser.add_argument("--hourglass", type=float, default=0.05, help="share of the element's stiffness")
    for name, value, text in (("friction", 0.2, "coefficient"), ("penalty", 1.0, "of contact, in E / h"), ("end", END, "ms"),
                              ("spacing", 4.0, "of contact points, mm"), ("safety", 0.8, "share of the critical step")):
        parser.add_argument(f"--{name}", type=float, default=value, help=f"{text} ({value})")
    parser.add_argument("--quarter", action="store_true", help="planes of symmetry x = 50 and y = 50; even divisions")
    parser.add_argument("--tell", type=int, default=0, help="print every so many steps")
    parser.add_argument("-o", "--output", help="series of all steps (.npz)")
    options = vars(parser.parse_args())
    if options["divisions"] < 1 or options["quarter"] and options["divisions"] % 2:
        parser.error("divisions: must be positive, and even for a quarter")
    output, began = options.pop("output"), clock.process_time()
    series = impact(**options)
    total = sum(series[name] for name in ("internal", "kinetic", "contact", "friction"))
    print(f"{len(series['time']) - 1} steps, {clock.process_time() - began:.0f} s CPU, least volume "
          f"{series['least_volume'].min():.3f}, energy error {abs(total / total[0] - 1).max():.1e}, impulse "
          f"{series['impulse'][-1]:.4f}, force at 0.5 ms {np.interp(0.5, series['time'], series['force']):.4f} kN")
    if output:
        np.savez(output, **series)


if __name__ == "__main__":
    main()
