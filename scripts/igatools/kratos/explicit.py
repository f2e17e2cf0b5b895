"""Explicit dynamics of a run file by Kratos' own central differences: its elements' forces, its row-sum masses, its time steps."""

import numpy as np

import KratosMultiphysics as KM
import KratosMultiphysics.StructuralMechanicsApplication as structural

from igatools.foreign_results import displacement_gradients
from igatools.kratos import stored_energy
from igatools.kratos.analysis import SolverError, System, refuse_gap_ends

DRIFT = 0.01  # of the energy balance, of the largest energy: a step above the limit of stability multiplies it within a few steps


class Stepper:
    """A body with initial velocities (n_f, 3) under nodal forces, stepped by Kratos."""

    def __init__(self, body, velocity, dt):
        self.body, self.dt, self.steps = body, dt, 0
        self.part, all_nodes = body.root.CreateSubModelPart("steps"), body.root.Nodes
        self.part.AddNodes([node.Id for node in body.nodes])
        self.part.AddElements([element.Id for element in body.part_of("stiffness").Elements])
        for number, node in enumerate(body.nodes, body.next_entity()):  # forces of loads reach the scheme by these alone
            self.part.CreateNewCondition("PointLoadCondition3D1N", number, [node.Id], body.properties)
        self.nodes, self.tools = all_nodes, KM.VariableUtils()
        self.set(KM.VELOCITY, velocity)
        scheme = structural.ExplicitCentralDifferencesScheme(dt, 1.0, 0.0)  # level 0: takes no step of its own
        self.strategy = structural.MechanicalExplicitStrategy(self.part, scheme, False, False, True)
        body.root.ProcessInfo[KM.DELTA_TIME] = dt
        self.strategy.Initialize()
        self.mass = np.array([node.GetValue(KM.NODAL_MASS) for node in body.nodes])

    def set(self, variable, values):
        self.tools.SetSolutionStepValuesVector(self.nodes, variable, KM.Vector(np.ravel(values)), 0)

    def step(self, force):
        """From t_n to t_{n+1} under the nodal forces (n_f, 3) of t_n."""
        self.set(structural.POINT_LOAD, force)
        self.steps += 1
        self.body.root.CloneTimeStep(self.steps * self.dt)
        self.strategy.InitializeSolutionStep()
        self.strategy.Predict()
        self.strategy.SolveSolutionStep()
        self.strategy.FinalizeSolutionStep()

    @property
    def displacement(self):
        return np.array(self.tools.GetSolutionStepValuesVector(self.nodes, KM.DISPLACEMENT, 0, 3)).reshape(-1, 3)


def start_velocity(model, run):
    """Coefficients (n_f, 3) of v + omega x (x - centre): control points reproduce linear fields."""
    x = model.control_points(model["/functions/number"])
    centre = run.spin_centre if run.spin_centre is not None else model.weights @ model.points / model.weights.sum()
    return run.velocity + np.cross(run.spin, x - centre)


def check_balance(run, start, rows):
    """By how much of the largest energy so far the last row's kinetic and strain energy miss what was put in."""
    time, kinetic, internal, work = rows[-1][:4]
    off = (kinetic + internal - work - start) / max(max(map(abs, row[1:4])) for row in rows)
    if not abs(off) <= DRIFT:
        raise SolverError(
            f"t = {time:.6g}: the energy balance is off by {off:.2g} of the largest energy: the step {run.dt:.4g} is too long; take a "
            "smaller dt_max in [time] (igasolve prints the limit)"
        )
    return off


def explicit(body, run, say=print):
    """Fields of write_results() at the end, with a table of the energies over time."""
    model = body.model
    refuse_gap_ends(model, "explicit")
    system = System(body, run)
    body.start()
    system.gather()
    body.properties.SetValue(KM.DENSITY, run.rho)  # it was 1 where forces per volume were gathered
    velocity = start_velocity(model, run)
    stepper = Stepper(body, velocity, run.dt)
    total = run.rho * model.weights.sum()
    if not abs(stepper.mass.sum() - total) <= 1e-9 * total:
        raise SolverError(f"Kratos' masses of the nodes add up to {stepper.mass.sum():.12g}, expected {total:.12g}")
    mass = stepper.mass[:, None]
    cells, parameters = model.point_cells(), model["/quadrature/parameters"]

    def force_at(time):
        return sum((run.factor(k, time) * f for k, f in enumerate(system.forces)), np.zeros(3 * len(mass))).reshape(-1, 3)

    def strain_energy(u):
        return float(
            model.weights @ stored_energy.density(run.law, run.E, run.nu, displacement_gradients(model, u, cells, parameters)[1])
        )

    start, work, every = float(0.5 * (mass * velocity**2).sum()), 0.0, max(1, run.steps // run.rows)
    rows = [(0.0, start, 0.0, 0.0, *(mass * velocity).sum(0))]
    u, u_next, force = np.zeros_like(velocity), np.zeros_like(velocity), force_at(0.0)
    for n in range(run.steps + 1):  # a step beyond the end gives the velocity there
        stepper.step(force)
        u_last, u, u_next = u, u_next, stepper.displacement
        if not np.isfinite(u_next).all():
            raise SolverError(f"step {n + 1}: the displacements run away; take a smaller dt_max in [time]")
        if n > 0 and (n % every == 0 or n == run.steps):
            before, after = (u - u_last) / run.dt, (u_next - u) / run.dt
            # With the product of both velocities, as igasolve has it, equal steps of a linear body keep the energy.
            kinetic = 0.5 * (mass * before * after).sum()
            rows.append((n * run.dt, kinetic, strain_energy(u), work, *(mass * (before + after) / 2).sum(0)))
            check_balance(run, start, rows)
        if n < run.steps:
            force, before = force_at((n + 1) * run.dt), force
            work += float(0.5 * ((before + force) * (u_next - u)).sum())
    units = {"time": "time"} | dict.fromkeys(("kinetic", "internal", "external_work"), "force*length")
    units |= {f"momentum_{axis}": "mass*length/time" for axis in "xyz"}
    table = {name: (unit, values) for (name, unit), values in zip(units.items(), np.array(rows).T)}
    say(f"  {run.steps} steps of {run.dt:.6g}; energy balance off by {check_balance(run, start, rows):.2g} of the largest energy")
    return system.report(u, rows[-1][2], work) | {"tables": {"energies": ("energies and momentum over time", table)}}
