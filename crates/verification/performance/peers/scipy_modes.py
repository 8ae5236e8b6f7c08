"""The lowest flexible modes of a scene's free body with SciPy's eigsh (ARPACK) on CHOLMOD.

CHOLMOD factors K + sM, ARPACK finds the modes of K φ = λ M φ by (K + sM)⁻¹ M φ = φ / (λ + s).

Usage: scipy_modes.py SCENE MODES FREQUENCY ORDERING      (prints JSON; s = (2π FREQUENCY)², in Hz)
"""

import time

laps = [("start", time.perf_counter())]

import json
import sys

import numpy as np
from matrices import Body, assemble, frequencies
from scipy.sparse.linalg import LinearOperator, eigsh
from sksparse.cholmod import cholesky

laps.append(("import", time.perf_counter()))
scene, modes, frequency, ordering = sys.argv[1:]
shift = (2 * np.pi * float(frequency)) ** 2
body = Body(scene)
laps.append(("mesh", time.perf_counter()))

# The transpose of a symmetric CSR matrix is the CSC matrix that CHOLMOD wants.
k, m = (matrix.T for matrix in assemble(body))
laps.append(("assembly", time.perf_counter()))

factor = cholesky((k + shift * m).tocsc(), ordering_method=ordering)
laps.append(("factor", time.perf_counter()))

inverse = LinearOperator(k.shape, matvec=factor, dtype=float)
eigenvalues = eigsh(k, 6 + int(modes), m, sigma=-shift, OPinv=inverse)[0]
laps.append(("eigsh", time.perf_counter()))

times = {name: end - begin for (_, begin), (name, end) in zip(laps, laps[1:])}
print(json.dumps({"unknowns": k.shape[0], "natural_frequencies": frequencies(eigenvalues), "times": times}))
