"""The motion of a reduced body in Exudyn's floating frame of reference (ObjectFFRFreducedOrder).

The body file that `flexframe reduce --matrices` has written gives the shapes, K and M; the scene gives the motion at the
beginning, damping and gravity. Attitude by Exudyn's rotation vector (Lie group), which has no constraint: RK4 can do it.

Usage: exudyn_loop.py SCENE BODY MODES generalized-alpha|RK4 STEP STEPS      (prints JSON)
"""

import json
import sys
import time
import tomllib
from pathlib import Path

sys.exudynFast = True  # Exudyn without range checks, with AVX2

import h5py
import numpy as np
import scipy.sparse as sparse

sys.stdout = sys.stderr  # Exudyn prints
import exudyn
from exudyn.FEM import FEMinterface, ObjectFFRFreducedOrderInterface

SOLVERS = {"generalized-alpha": exudyn.DynamicSolverType.GeneralizedAlpha, "RK4": exudyn.DynamicSolverType.RK44}
scene, file, modes, scheme, step, steps = sys.argv[1:]
modes, end = int(modes), float(step) * int(steps)
scene, body = tomllib.loads(Path(scene).read_text()), h5py.File(file)


def matrix(name):
    parts = body["matrices"][name]
    return sparse.csc_matrix((parts["data"][:], parts["indices"][:], parts["indptr"][:])).tocsr()


fem = FEMinterface()
fem.nodes = {"Position": body["mesh/positions"][:] - body["constants/center_of_mass"][:]}
fem.massMatrix, fem.stiffnessMatrix = matrix("mass"), matrix("stiffness")
fem.modeBasis = {"matrix": body["modes/shapes"][:modes].reshape(modes, -1).T, "type": "NormalModes"}
reduced = ObjectFFRFreducedOrderInterface(fem, rigidBodyNodeType="NodeType.RotationRotationVector")

initial = scene["initial"]
gravity = next(load for load in scene["loads"] if load["kind"] == "gravity")
container = exudyn.SystemContainer()
system = container.AddSystem()
added = reduced.AddObjectFFRFreducedOrder(
    system,
    initialVelocity=initial["velocity"],
    initialAngularVelocity=initial["angular_velocity"],
    gravity=list(gravity["amplitude"] * np.array(gravity["direction"])),
)
rates = np.zeros(modes)
rates[: len(initial["modal_velocity"])] = initial["modal_velocity"]
system.SetNodeParameter(added["nGenericODE2"], "initialCoordinates_t", rates)
damping = exudyn.MatrixContainer()
damping.SetWithDenseMatrix(
    np.diag(2 * scene["modes"]["damping_ratio"] * body["modes/circular_frequencies"][:modes]), useDenseMatrix=False
)
system.SetObjectParameter(added["oFFRFreducedOrder"], "dampingMatrixReduced", damping)
system.Assemble()

settings = exudyn.SimulationSettings()
settings.timeIntegration.numberOfSteps = int(steps)
settings.timeIntegration.endTime = end
settings.timeIntegration.generalizedAlpha.spectralRadius = 1  # no numerical damping: the most accurate
settings.timeIntegration.verboseMode = 0
settings.solution.file.write = False
begin = time.process_time()
system.SolveDynamic(settings, solverType=SOLVERS[scheme])
seconds = time.process_time() - begin

attitude = system.GetNodeOutput(added["nRigidBody"], exudyn.OutputVariableType.RotationMatrix)
print(json.dumps({"seconds": seconds, "attitude": attitude.tolist()}), file=sys.__stdout__)
