"""A model as Kratos geometry, elements and conditions, and the matrices and vectors that Kratos assembles from them.

Each cell is a NurbsVolumeGeometry of one span: the 2 p knots about it and its (p + 1)^3 control points, which on that span is the whole
grid's spline exactly. Its nodes are the copies that /cells/functions names, so cells on two sides of a gap share no node where the
model does not. Quadrature points are the model's own: no rule of Kratos comes in.
"""

import numpy as np

import KratosMultiphysics as KM
import KratosMultiphysics.ConstitutiveLawsApplication as laws
import KratosMultiphysics.IgaApplication as iga
import KratosMultiphysics.StructuralMechanicsApplication as structural
from KratosMultiphysics import scipy_conversion_tools

from igatools import iga_model

OF_STEPS = (KM.VELOCITY, KM.ACCELERATION, KM.FORCE_RESIDUAL, KM.RESIDUAL_VECTOR, structural.MIDDLE_VELOCITY, structural.POINT_LOAD)
DERIVATIVES = 2  # of shape functions: Kratos takes no other number
LAWS = {
    "linear-elastic": ("SmallDisplacementElement3D8N", structural.LinearElastic3DLaw),
    "st-venant-kirchhoff": ("TotalLagrangianElement3D8N", laws.KirchhoffSaintVenant3DLaw),
    "neo-hookean": ("TotalLagrangianElement3D8N", laws.HyperElastic3DLaw),
}  # 8N is a name: the nodes are those of the geometry


def vector(values):
    out = KM.Vector(len(values))
    for k, value in enumerate(values):
        out[k] = float(value)
    return out


def gauss_points(model, span):
    """Parameters (n, 3) and weights (n) of the Gauss rule with p + 1 points a direction on a whole span."""
    rules = [np.polynomial.legendre.leggauss(p + 1) for p in model.degree]
    low = [model.knots[d][span[d] + p] for d, p in enumerate(model.degree)]
    size = [model.knots[d][span[d] + p + 1] - low[d] for d, p in enumerate(model.degree)]
    u = np.stack(
        np.meshgrid(*(low[d] + (x + 1) / 2 * size[d] for d, (x, _) in enumerate(rules)), indexing="ij"), 3
    ).reshape(-1, 3)
    return u, np.einsum("i,j,k->ijk", *(w / 2 * size[d] for d, (_, w) in enumerate(rules))).ravel()


class Body:
    """Nodes: one for each entry of /functions, in its order, number 1 the first. Parts of the model part ("stiffness", "mass", and one for
    each support and load) are assembled alone by assemble(). `steps`: nodes have what Kratos' explicit scheme needs."""

    def __init__(self, model, E, nu, law="linear-elastic", steps=False):
        self.model = model
        KM.Logger.GetDefaultOutput().SetSeverity(KM.Logger.Severity.WARNING)
        self._kratos = KM.Model()
        self.root = self._kratos.CreateModelPart("solid")
        self.root.ProcessInfo[KM.DOMAIN_SIZE] = 3
        for variable in (KM.DISPLACEMENT, KM.REACTION, KM.VOLUME_ACCELERATION, *(OF_STEPS if steps else ())):
            self.root.AddNodalSolutionStepVariable(variable)
        for number, x in enumerate(model.control_points(model["/functions/number"]), 1):
            self.root.CreateNewNode(number, *map(float, x))
        self.nodes = [self.root.Nodes[number] for number in range(1, len(model["/functions/number"]) + 1)]
        self.functions, self.spans = model["/cells/functions"], model.cell_spans()
        self._entities, self._properties, self._volumes = 0, 0, []
        element, constitutive = LAWS[law]
        properties = self.new_properties({KM.YOUNG_MODULUS: E, KM.POISSON_RATIO: nu, KM.DENSITY: 1.0})
        properties.SetValue(KM.CONSTITUTIVE_LAW, constitutive())
        self.properties = properties
        part, offsets = self.part("stiffness"), model["/quadrature/offsets"]
        for cell in np.flatnonzero(np.diff(offsets)):
            here = slice(offsets[cell], offsets[cell + 1])
            geometry = self.geometry(cell, model["/quadrature/parameters"][here], model.weights[here])
            self._entities += 1
            part.CreateNewElement(element, self._entities, geometry, properties)

    def part_of(self, name):
        return self._kratos[f"solid.{name}"]

    def next_entity(self):
        """Number that no element and no condition has, nor any after it."""
        return self._entities + 1

    def part(self, name):
        part = self.root.CreateSubModelPart(name)
        part.AddNodes(list(range(1, len(self.nodes) + 1)))
        return part

    def new_properties(self, values):
        self._properties += 1
        properties = self.root.CreateNewProperties(self._properties)
        for variable, value in values.items():
            properties.SetValue(variable, float(value))
        return properties

    def geometry(self, cell, parameters, weights):
        """One geometry with the given points (n, 3) and weights (n) in a cell. It keeps what conditions on it are told by SetValue: none is
        shared."""
        nodes = KM.NodesVector()
        for function in self.functions[cell]:
            nodes.append(self.nodes[function])
        knots = [
            vector(self.model.knots[d][s + 1 : s + 2 * p + 1])
            for d, (s, p) in enumerate(zip(self.spans[cell], self.model.degree))
        ]
        volume, made = KM.NurbsVolumeGeometry(nodes, *self.model.degree, *knots), KM.GeometriesVector()
        self._volumes.append(volume)  # Kratos keeps a bare pointer to it
        volume.CreateQuadraturePointGeometries(made, DERIVATIVES, np.column_stack([parameters, weights]).tolist())
        return made[0]

    def condition(self, part, kind, cell, parameters, weights, properties, values):
        self._entities += 1
        condition = part.CreateNewCondition(kind, self._entities, self.geometry(cell, parameters, weights), properties)
        for variable, value in values.items():
            condition.SetValue(variable, [float(v) for v in value])

    def add_mass(self, rho):
        """The consistent mass, as the penalty condition's matrix with the factor rho at points inside: the elements' own takes a Gauss rule
        that a geometry of given points does not have, and comes out as zero. Where interior spans have reduced rules it takes p + 1 Gauss
        points a direction there, as igasolve does."""
        model, part, properties = self.model, self.part("mass"), self.new_properties({iga.PENALTY_FACTOR: rho})
        reduced = model.attribute("/quadrature", "interior_rule") != "gauss"
        offsets = model["/quadrature/offsets"]
        for cell, span in enumerate(self.spans):
            here = slice(offsets[cell], offsets[cell + 1])
            points = model["/quadrature/parameters"][here], model.weights[here]
            if reduced and model["/cells/state"][cell] == iga_model.INTERIOR:
                points = gauss_points(model, span)
            if len(points[1]):
                self.condition(part, "SupportPenaltyCondition", cell, *points, properties, {KM.DISPLACEMENT: (0, 0, 0)})

    def add_support(self, name, points, beta, prescribed):
        """Penalty beta (force/length^3) in all three components on surface points; prescribed displacements (n, 3)."""
        part, properties = self.part(name), self.new_properties({iga.PENALTY_FACTOR: beta})
        self._on_surface(part, "SupportPenaltyCondition", points, properties, KM.DISPLACEMENT, prescribed)

    def add_traction(self, part, points, traction):
        """Force/area (n, 3) on surface points."""
        self._on_surface(
            part, "LoadCondition", points, self.new_properties({}), iga.SURFACE_LOAD, traction, together=False
        )

    def _on_surface(self, part, kind, points, properties, variable, values, together=True):
        """One condition for each run of points of a cell with the same value; for each point where Kratos' condition adds up several wrongly."""
        group = "/surface/quadrature"
        cells, parameters, weights = (
            self.model.point_cells(group)[points],
            self.model[group + "/parameters"][points],
            self.model[group + "/weights"][points],
        )
        apart = (np.diff(cells) != 0) | (np.diff(values, axis=0) != 0).any(1) | (not together)
        new = np.flatnonzero(np.r_[True, apart])
        for first, last in zip(new, np.r_[new[1:], len(points)]):
            self.condition(
                part,
                kind,
                cells[first],
                parameters[first:last],
                weights[first:last],
                properties,
                {variable: values[first]},
            )

    def start(self):
        """After the last condition: numbers the unknowns."""
        for name in "XYZ":
            KM.VariableUtils().AddDof(
                KM.KratosGlobals.GetVariable(f"DISPLACEMENT_{name}"),
                KM.KratosGlobals.GetVariable(f"REACTION_{name}"),
                self.root,
            )
        self._scheme = KM.ResidualBasedIncrementalUpdateStaticScheme()
        self._builder = KM.ResidualBasedBlockBuilderAndSolver(KM.SkylineLUFactorizationSolver())
        self._strategy = KM.ResidualBasedLinearStrategy(
            self.root, self._scheme, self._builder, False, False, False, False
        )
        self._strategy.Check()
        self._strategy.Initialize()
        self._strategy.InitializeSolutionStep()
        self._rows = np.array(
            [
                node.GetDof(variable).EquationId
                for node in self.nodes
                for variable in (KM.DISPLACEMENT_X, KM.DISPLACEMENT_Y, KM.DISPLACEMENT_Z)
            ]
        )

    def assemble(self, name):
        """Tangent (3 n, 3 n) and residual (3 n), external minus internal forces, of one part as Kratos assembles it at the nodes' present
        displacements; row 3 f + d belongs to component d of function f."""
        space = KM.UblasSparseSpace()
        A, b = self._strategy.GetSystemMatrix(), self._strategy.GetSystemVector()
        space.SetToZeroMatrix(A)
        space.SetToZeroVector(b)
        self._builder.Build(self._scheme, self.part_of(name), A, b)
        return scipy_conversion_tools.to_csr(A)[self._rows][:, self._rows], np.array(b)[self._rows]

    def displace(self, u):
        """Coefficients (n_f, 3) become the nodes' displacements. Total Lagrangian elements take the deformation from moved nodes."""
        for node, value in zip(self.nodes, u):
            node.SetSolutionStepValue(KM.DISPLACEMENT, [float(v) for v in value])
            node.X, node.Y, node.Z = node.X0 + value[0], node.Y0 + value[1], node.Z0 + value[2]

    def body_force(self, force):
        """Right-hand side (3 n) of a force/volume (3) everywhere, from the elements: their density is 1."""
        for value in (force, (0.0, 0.0, 0.0)):
            here = self.assemble("stiffness")[1] if value is not force else None
            for node in self.nodes:
                node.SetSolutionStepValue(KM.VOLUME_ACCELERATION, [float(v) for v in value])
        return here
