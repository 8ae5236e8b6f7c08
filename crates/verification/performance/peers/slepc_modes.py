"""The lowest flexible modes of a scene's free body with SLEPc's Krylov-Schur on MUMPS.

Every rank assembles the rows of its own nodes; MUMPS factors K + sM (symmetric, which SLEPc does not tell it to be definite: LDLᵀ).

Usage: [mpirun -n RANKS] slepc_modes.py SCENE MODES FREQUENCY      (rank 0 prints JSON; s = (2π FREQUENCY)², in Hz)
"""

import time

laps = [("start", time.perf_counter())]

import json
import resource
import sys

import numpy as np
import slepc4py

slepc4py.init([])
from matrices import Body, assemble, frequencies
from petsc4py import PETSc
from slepc4py import SLEPc

laps.append(("import", time.perf_counter()))
scene, modes, frequency = sys.argv[1:]
shift = (2 * np.pi * float(frequency)) ** 2
ranks = PETSc.COMM_WORLD
body = Body(scene)
body.sort_along_x()
nodes = len(body.points)
first, last = (nodes * (ranks.rank + step) // ranks.size for step in (0, 1))
laps.append(("mesh", time.perf_counter()))


def distributed(rows):
    """A PETSc matrix of the rows of each rank."""
    size = (rows.shape[0], 3 * nodes)
    matrix = PETSc.Mat().createAIJ((size, size), csr=(rows.indptr, rows.indices, rows.data), comm=ranks)
    matrix.setOption(PETSc.Mat.Option.SYMMETRIC, True)
    matrix.setOption(PETSc.Mat.Option.SPD, True)
    return matrix


k, m = map(distributed, assemble(body, first, last))
unknowns = 3 * nodes
del body
laps.append(("assembly", time.perf_counter()))

solver = SLEPc.EPS().create(ranks)
solver.setOperators(k, m)
solver.setProblemType(SLEPc.EPS.ProblemType.GHEP)
solver.setType(SLEPc.EPS.Type.KRYLOVSCHUR)
solver.setDimensions(6 + int(modes))
solver.setWhichEigenpairs(SLEPc.EPS.Which.TARGET_MAGNITUDE)
solver.setTarget(-shift)
transform = solver.getST()
transform.setType(SLEPc.ST.Type.SINVERT)
linear = transform.getKSP()
linear.setType(PETSc.KSP.Type.PREONLY)
preconditioner = linear.getPC()
preconditioner.setType(PETSc.PC.Type.CHOLESKY)
preconditioner.setFactorSolverType(PETSc.Mat.SolverType.MUMPS)
solver.setUp()
laps.append(("factor", time.perf_counter()))
solver.solve()
laps.append(("Krylov-Schur", time.perf_counter()))

count = min(solver.getConverged(), 6 + int(modes))
eigenvalues = np.array([solver.getEigenvalue(index).real for index in range(count)])

# What mpirun reports of its children is the largest of them, so the ranks tell it themselves.
memory = PETSc.Vec().createMPI(ranks.size, comm=ranks)
memory.setValue(ranks.rank, 1024 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss)
memory.assemble()
memory = memory.sum()

if ranks.rank == 0:
    times = {name: end - begin for (_, begin), (name, end) in zip(laps, laps[1:])}
    answer = {"unknowns": unknowns, "natural_frequencies": frequencies(eigenvalues), "times": times, "memory": memory}
    print(json.dumps(answer))
