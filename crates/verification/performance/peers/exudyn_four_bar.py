"""The four-bar with a hinge out of line, of geometrically exact beams in Exudyn: the reference of the test of crates/verification.

Bars of 0.12, 0.24 and 0.12 m (Bauchau et al. 2016: EI, GJ and masses), around A (0, 0), B (0, 0.12), C (0.24, 0.12) and D (0.24, 0). Hinges about z
but for that at C, whose axis is turned by 5 degrees about y. Bar AB is turned at A by 0.6 rad/s from the start.

Usage: exudyn_four_bar.py ELEMENTS STEPS END     (prints times, turn at D, rotation of the middle of BC about x and its displacement along z)
"""

import sys

sys.exudynFast = True
elements, steps, end = int(sys.argv[1]), int(sys.argv[2]), float(sys.argv[3])

import warnings

warnings.simplefilter("ignore")
import exudyn
import numpy as np
from exudyn.itemInterface import (
    GenericJoint,
    MarkerBodyRigid,
    MarkerNodeRigid,
    NodeRigidBodyRotVecLG,
    ObjectBeamGeometricallyExact,
    SensorNode,
)
from exudyn.utilities import RigidBodyInertia

SPEED = 0.6
container = exudyn.SystemContainer()
system = container.AddSystem()
ground = system.CreateGround()


def section(side):
    young, poisson, density = 207e9, 0.3, 7800.0
    shear = young / (2 * (1 + poisson))
    area, moment, torsion = side**2, side**4 / 12, 0.140577 * side**4
    found = exudyn.BeamSection()
    k = 5 / 6 * shear * area
    found.stiffnessMatrix = np.diag([young * area, k, k, shear * torsion, young * moment, young * moment])
    found.inertia = density * np.diag([2 * moment, moment, moment])
    found.massPerLength = density * area
    return found


def bar(start, stop, side, velocity, omega):
    """Nodes along a bar that moves with this velocity at its start, and turns about z; and its axes."""
    start, stop = np.array(start, float), np.array(stop, float)
    x = (stop - start) / np.linalg.norm(stop - start)
    turned = np.column_stack([x, np.cross([0, 0, 1], x), [0, 0, 1]])
    rotation = vector(turned)
    nodes = [
        system.AddNode(
            NodeRigidBodyRotVecLG(
                referenceCoordinates=[*(start + part * (stop - start)), *rotation],
                initialVelocities=[*(velocity + np.cross([0, 0, omega], part * (stop - start))), 0, 0, omega],
            )
        )
        for part in np.linspace(0, 1, elements + 1)
    ]
    for pair in zip(nodes, nodes[1:]):
        system.AddObject(
            ObjectBeamGeometricallyExact(
                nodeNumbers=list(pair), length=np.linalg.norm(stop - start) / elements, sectionData=section(side)
            )
        )
    return nodes, turned


def vector(turned):
    """Rotation vector of a turn about z."""
    return [0, 0, np.arctan2(turned[1, 0], turned[0, 0])]


def axes(axis):
    z = np.array(axis, float) / np.linalg.norm(axis)
    y = np.array([0.0, 1.0, 0.0])
    return np.column_stack([np.cross(y, z), y, z])


def hinge(first, second, axis, held=0):
    markers, turns = [], []
    for node, turned in (first, second):
        markers.append(node)
        turns.append(turned.T @ axes(axis))
    return system.AddObject(
        GenericJoint(
            markerNumbers=markers,
            constrainedAxes=[1, 1, 1, 1, 1, held],
            rotationMarker0=turns[0],
            rotationMarker1=turns[1],
        )
    )


node = lambda number: system.AddMarker(MarkerNodeRigid(nodeNumber=number))
place = lambda at: system.AddMarker(MarkerBodyRigid(bodyNumber=ground, localPosition=at))
a, b, c, d = [0, 0, 0], [0, 0.12, 0], [0.24, 0.12, 0], [0.24, 0, 0]
rest = np.zeros(3)
speed = np.array([-SPEED * 0.12, 0, 0])
one, one_axes = bar(a, b, 0.016, rest, SPEED)
two, two_axes = bar(b, c, 0.016, speed, 0.0)
three, three_axes = bar(c, d, 0.008, speed, SPEED)
still = np.eye(3)
tilt = np.deg2rad(5.0)
# A flywheel that nothing slows turns the first bar.
wheel = system.CreateRigidBody(
    inertia=RigidBodyInertia(mass=1.0, com=[0, 0, 0], inertiaTensor=1e4 * np.eye(3)),
    nodeType=exudyn.NodeType.RotationRotationVector,
    initialAngularVelocity=[0, 0, SPEED],
)
on_wheel = lambda: system.AddMarker(MarkerBodyRigid(bodyNumber=wheel, localPosition=[0, 0, 0]))
hinge((place(a), still), (on_wheel(), still), [0, 0, 1])
hinge((on_wheel(), still), (node(one[0]), one_axes), [0, 0, 1], held=1)
hinge((node(one[-1]), one_axes), (node(two[0]), two_axes), [0, 0, 1])
hinge((node(two[-1]), two_axes), (node(three[0]), three_axes), [np.sin(tilt), 0, np.cos(tilt)])
hinge((node(three[-1]), three_axes), (place(d), still), [0, 0, 1])
middle = two[elements // 2]
kinds = [(middle, exudyn.OutputVariableType.Displacement), (three[-1], exudyn.OutputVariableType.RotationMatrix)]
sensors = [system.AddSensor(SensorNode(nodeNumber=n, outputVariableType=kind, storeInternal=True)) for n, kind in kinds]
system.Assemble()
settings = exudyn.SimulationSettings()
settings.timeIntegration.numberOfSteps = steps
settings.timeIntegration.endTime = end
settings.timeIntegration.generalizedAlpha.spectralRadius = 0.5
settings.timeIntegration.newton.useModifiedNewton = True
settings.timeIntegration.newton.relativeTolerance = 1e-6
settings.timeIntegration.newton.absoluteTolerance = 1e-8
settings.timeIntegration.verboseMode = 0
settings.solution.file.write = False
settings.solution.sensors.writePeriod = end / 12
done = system.SolveDynamic(settings)
moved, turned = (system.GetSensorStoredData(sensor) for sensor in sensors)
for row, rotation in zip(moved, turned):
    r = rotation[1:].reshape(3, 3) @ three_axes.T
    print(f"{row[0]:.3f} middle of BC moved by {row[1]:.6f} {row[2]:.6f} {row[3]:.7f}, D turned by {np.arctan2(r[1, 0], r[0, 0]):.6f}")
