"""A system of bodies with joints in Exudyn: rigid bodies, and reduced bodies in floating frames (ObjectFFRFreducedOrder) with the
modes and static shapes of body files that `flexframe reduce --matrices` has written.

Markers are the means of faces as in flexframe (MarkerSuperElementRigid, weights by areas); joints are GenericJoints. Implicit
generalized-alpha, Newton, index 3 as Exudyn has it by default.

Usage: exudyn_system.py SCENE FOLDER BODY POINT RADIUS ROWS STEPS...      (prints JSON, a line for each number of steps)
FOLDER has BODY.body.h5 of each flexible body. RADIUS is the spectral radius of generalized-alpha. The position of POINT of BODY and its
elastic displacement, in the axes of the body, are told at ROWS equal times.
"""

import json
import sys
import time
import tomllib
import warnings
from pathlib import Path

sys.exudynFast = True  # Exudyn without range checks, with AVX2

import h5py
import meshio
import numpy as np
import scipy.sparse as sparse
from scipy.spatial import cKDTree

sys.stdout = sys.stderr  # Exudyn prints
warnings.simplefilter("ignore", DeprecationWarning)  # rotationMarker0 goes in 2031
import exudyn
from exudyn.FEM import FEMinterface, ObjectFFRFreducedOrderInterface
from exudyn.itemInterface import (
    GenericJoint,
    MarkerBodyRigid,
    MarkerSuperElementPosition,
    MarkerSuperElementRigid,
    SensorMarker,
    SensorSuperElement,
)
from exudyn.utilities import InertiaTensor2Inertia6D, RigidBodyInertia

LOCKED = {
    "revolute": [1, 1, 1, 1, 1, 0],
    "spherical": [1, 1, 1, 0, 0, 0],
    "prismatic": [1, 1, 0, 1, 1, 1],
}
path, folder, tracked, point, radius, rows = (*sys.argv[1:5], float(sys.argv[5]), int(sys.argv[6]))
scene = tomllib.loads(Path(path).read_text())
end = scene["time"]["end"]


def axes_about(axis):
    """Columns x, y, z with z along an axis."""
    z = np.array(axis, float) / np.linalg.norm(axis)
    x = np.eye(3)[np.argmin(np.abs(z))]
    x = x - z * (x @ z)
    x /= np.linalg.norm(x)
    return np.column_stack([x, np.cross(z, x), z])


def matrix(file, name):
    parts = file["matrices"][name]
    return sparse.csc_matrix((parts["data"][:], parts["indices"][:], parts["indptr"][:])).tocsr()


def faces_of(mesh, group):
    """Nodes of a physical surface and the part of each in its mean: a third of each flat face on its mid-edge nodes."""
    weights = {}
    tag = int(mesh.field_data[group][0])
    for cells, tags in zip(mesh.cells, mesh.cell_data["gmsh:physical"]):
        if cells.type != "triangle6":
            continue
        for nodes in cells.data[tags == tag]:
            a, b, c = mesh.points[nodes[:3]]
            area = 0.5 * np.linalg.norm(np.cross(b - a, c - a))
            for node in nodes[3:]:
                weights[node] = weights.get(node, 0.0) + area / 3
    nodes = np.array(sorted(weights))
    values = np.array([weights[node] for node in nodes])
    return nodes, values / values.sum()


class Rigid:
    def __init__(self, system, body, gravity):
        rigid, initial = body["rigid"], body.get("initial", {})
        inertia = RigidBodyInertia(mass=rigid["mass"], com=[0, 0, 0], inertiaTensor=np.array(rigid["inertia"], float))
        added = system.CreateRigidBody(
            inertia=inertia,
            nodeType=exudyn.NodeType.RotationRotationVector,
            referencePosition=initial.get("position", [0, 0, 0]),
            initialVelocity=initial.get("velocity", [0, 0, 0]),
            initialAngularVelocity=initial.get("angular_velocity", [0, 0, 0]),
            gravity=gravity,
            returnDict=True,
        )
        self.number, self.center = added["bodyNumber"], np.array(rigid["center_of_mass"], float)

    def marker(self, system, marker):
        return system.AddMarker(MarkerBodyRigid(bodyNumber=self.number, localPosition=np.array(marker["at"], float) - self.center))


class Flexible:
    def __init__(self, system, name, body, gravity):
        file = h5py.File(Path(folder) / f"{name}.body.h5")
        count = sum(file[kind]["shapes"].shape[0] for kind in ("modes", "static_shapes") if kind in file)
        shapes = [file[kind]["shapes"][:] for kind in ("modes", "static_shapes") if kind in file]
        frequencies = [file[kind]["circular_frequencies"][:] for kind in ("modes", "static_shapes") if kind in file]
        self.center = file["constants/center_of_mass"][:]
        self.positions = file["mesh/positions"][:]
        fem = FEMinterface()
        fem.nodes = {"Position": self.positions - self.center}
        fem.massMatrix, fem.stiffnessMatrix = matrix(file, "mass"), matrix(file, "stiffness")
        fem.modeBasis = {"matrix": np.concatenate(shapes).reshape(count, -1).T, "type": "NormalModes"}
        reduced = ObjectFFRFreducedOrderInterface(fem, rigidBodyNodeType="NodeType.RotationRotationVector")
        initial = body.get("initial", {})
        added = reduced.AddObjectFFRFreducedOrder(
            system,
            positionRef=list(np.array(initial.get("position", [0, 0, 0]), float) + self.center),
            initialVelocity=initial.get("velocity", [0, 0, 0]),
            initialAngularVelocity=initial.get("angular_velocity", [0, 0, 0]),
            gravity=list(gravity),
        )
        ratios = np.full(count, 2 * body["modes"]["damping_ratio"])
        damping = exudyn.MatrixContainer()
        damping.SetWithDenseMatrix(np.diag(ratios * np.concatenate(frequencies)), useDenseMatrix=False)
        self.number = added["oFFRFreducedOrder"]
        system.SetObjectParameter(self.number, "dampingMatrixReduced", damping)
        self.mesh = meshio.read(Path(path).parent / body["mesh"])
        self.find = cKDTree(self.positions)
        self.count = count

    def marker(self, system, marker):
        nodes, weights = faces_of(self.mesh, marker["group"])
        numbers = self.find.query(self.mesh.points[nodes])[1]
        return system.AddMarker(
            MarkerSuperElementRigid(
                bodyNumber=self.number, meshNodeNumbers=numbers.tolist(), weightingFactors=weights.tolist()
            )
        )

    def node(self, at):
        return int(self.find.query(at)[1])

    def point(self, system, at):
        number = self.node(at)
        return system.AddMarker(
            MarkerSuperElementPosition(bodyNumber=self.number, meshNodeNumbers=[number], weightingFactors=[1.0])
        )


def build():
    container = exudyn.SystemContainer()
    system = container.AddSystem()
    ground = system.CreateGround()
    bodies = {}
    for name, body in scene["bodies"].items():
        loads = body.get("loads", [])
        gravity = sum((load["amplitude"] * np.array(load["direction"], float) for load in loads), np.zeros(3))
        bodies[name] = Rigid(system, body, gravity) if "rigid" in body else Flexible(system, name, body, gravity)
    for joint in scene["joints"]:
        markers, places = [], []
        for between in joint["between"]:
            if between == "ground":
                markers.append(None)
                continue
            name, marker = between.split(".")
            markers.append(bodies[name].marker(system, scene["bodies"][name]["markers"][marker]))
            places.append((name, scene["bodies"][name]["markers"][marker]))
        if None in markers:
            # Where the other end is.
            name, marker = places[0]
            if "at" in marker:
                at = np.array(marker["at"], float)
            else:
                nodes, weights = faces_of(bodies[name].mesh, marker["group"])
                at = weights @ bodies[name].mesh.points[nodes]
            at = at + np.array(scene["bodies"][name].get("initial", {}).get("position", [0, 0, 0]), float)
            markers[markers.index(None)] = system.AddMarker(MarkerBodyRigid(bodyNumber=ground, localPosition=at))
        turned = axes_about(joint.get("axis", [0, 0, 1]))
        system.AddObject(
            GenericJoint(
                markerNumbers=markers,
                constrainedAxes=LOCKED[joint["kind"]],
                rotationMarker0=turned,
                rotationMarker1=turned,
            )
        )
    at = scene["bodies"][tracked]["points"][point]
    sensor = system.AddSensor(
        SensorMarker(
            markerNumber=bodies[tracked].point(system, at),
            outputVariableType=exudyn.OutputVariableType.Position,
            storeInternal=True,
        )
    )
    bent = system.AddSensor(
        SensorSuperElement(
            bodyNumber=bodies[tracked].number,
            meshNodeNumber=bodies[tracked].node(at),
            outputVariableType=exudyn.OutputVariableType.DisplacementLocal,
            storeInternal=True,
        )
    )
    system.Assemble()
    return container, system, [sensor, bent]


for steps in map(int, sys.argv[7:]):
    container, system, sensors = build()
    settings = exudyn.SimulationSettings()
    settings.timeIntegration.numberOfSteps = steps
    settings.timeIntegration.endTime = end
    settings.timeIntegration.generalizedAlpha.spectralRadius = radius
    settings.timeIntegration.newton.useModifiedNewton = True
    settings.timeIntegration.verboseMode = 0
    settings.solution.file.write = False
    settings.solution.sensors.writePeriod = end / rows
    settings.linearSolver.solverType = exudyn.LinearSolverType.EXUdense
    begin = time.process_time()
    try:
        done = system.SolveDynamic(settings)
    except Exception:
        done = False
    seconds = time.process_time() - begin
    positions, displacements = (system.GetSensorStoredData(sensor)[:, 1:4].tolist() if done else None for sensor in sensors)
    found = {"steps": steps, "seconds": seconds, "positions": positions, "displacements": displacements}
    print(json.dumps(found), file=sys.__stdout__, flush=True)
