"""The twenty lowest flexible modes of the paper's plate with NumPy, SciPy and CHOLMOD.

A second implementation of `flexframe modes`, written from the textbook and sharing nothing with it:
meshio reads the mesh, NumPy assembles K and M, CHOLMOD factors K + sM, ARPACK finds the modes of

    K φ = λ M φ        by        (K + sM)⁻¹ M φ = φ / (λ + s).

Usage: peer.py MESH.msh        (prints JSON)
"""

import time

laps = [("start", time.perf_counter())]

import json
import sys
from pathlib import Path

import meshio
import numpy as np
import scipy
import scipy.sparse as sparse
import sksparse
from scipy.sparse.linalg import LinearOperator, eigsh
from sksparse.cholmod import cholesky

laps.append(("import", time.perf_counter()))

# The plate of the paper, in mm, Mg, s.
YOUNG, POISSON, DENSITY = 70000.0, 0.33, 2.7e-9
POINT_MASS = 0.001
POINTS = np.array([[x, y, z] for x in (-500, 500) for y in (-25, 25) for z in (0, 10)], float)

RIGID, FLEXIBLE = 6, 20
SHIFT = (2 * np.pi * 24.5) ** 2

# The corners that each mid-edge node lies between, in gmsh's order. meshio puts gmsh's last two nodes
# in VTK's order when it reads them, so the table is VTK's; `check_order` refuses anything else.
EDGES = np.array([[0, 1], [1, 2], [0, 2], [0, 3], [1, 3], [2, 3]])


def check_order(points, tets):
    """Every node 4..9 of these straight elements lies in the middle of its edge."""
    middle = points[tets[:, EDGES]].mean(axis=2)
    if not np.allclose(points[tets[:, 4:]], middle, rtol=0, atol=1e-6):
        sys.exit("peer: mid-edge nodes are not in the order 01, 12, 02, 03, 13, 23")


def element_mass():
    """The 10×10 mass of a straight element of unit volume and density, integrated in closed form."""
    shared = (EDGES[:, None, :, None] == EDGES[None, :, None, :]).sum(axis=(2, 3))
    on_edge = (EDGES[None, :, :] == np.arange(4)[:, None, None]).any(axis=2)
    corners = np.ones((4, 4)) + 5 * np.eye(4)
    across = np.where(on_edge, -4.0, -6.0)
    edges = np.array([8.0, 16.0, 32.0])[shared]
    return np.block([[corners, across], [across.T, edges]]) / 420


def shape_gradients(corner_gradients):
    """∇N at the four quadrature points (e×4×10×3) from the ∇L of the corners (e×4×3)."""
    near, far = (5 + 3 * 5**0.5) / 20, (5 - 5**0.5) / 20
    at = np.full((4, 4), far) + (near - far) * np.eye(4)
    # N = L(2L − 1) at a corner and 4 La Lb on an edge, so ∇N = Σ_c ∂N/∂L_c ∇L_c.
    by_corner = np.zeros((4, 10, 4))
    by_corner[:, np.arange(4), np.arange(4)] = 4 * at - 1
    for edge, (a, b) in enumerate(EDGES, start=4):
        by_corner[:, edge, a] = 4 * at[:, b]
        by_corner[:, edge, b] = 4 * at[:, a]
    return np.matmul(by_corner, corner_gradients[:, None])


def element_stiffness(gradients, volumes):
    """K_ab = ∫ λ ∇Na ⊗ ∇Nb + μ (∇Nb ⊗ ∇Na + ∇Na·∇Nb 1), as e×10×10×3×3."""
    lame = YOUNG * POISSON / ((1 + POISSON) * (1 - 2 * POISSON))
    shear = YOUNG / (2 * (1 + POISSON))
    elements = len(volumes)
    # ∫ ∇Na ⊗ ∇Nb as one product of 30×4 by 4×30 in each element.
    weighted = (gradients * np.sqrt(volumes / 4)[:, None, None, None]).reshape(elements, 4, 30)
    outer = np.matmul(weighted.transpose(0, 2, 1), weighted).reshape(elements, 10, 3, 10, 3)
    outer = outer.transpose(0, 1, 3, 2, 4)
    stiffness = lame * outer + shear * outer.swapaxes(3, 4)
    stiffness[..., range(3), range(3)] += shear * np.trace(outer, axis1=3, axis2=4)[..., None]
    return stiffness


def assemble(points, tets):
    """K and M (CSC, both symmetric)."""
    edges = points[tets[:, 1:4]] - points[tets[:, :1]]
    volumes = np.linalg.det(edges) / 6
    inner = np.linalg.inv(edges).transpose(0, 2, 1)
    corner_gradients = np.concatenate([-inner.sum(axis=1, keepdims=True), inner], axis=1)
    stiffness = element_stiffness(shape_gradients(corner_gradients), volumes)

    # The pattern is that of the nodes: sorting 100 pairs an element instead of 900 entries.
    nodes = len(points)
    pairs = (tets[:, :, None] * nodes + tets[:, None, :]).ravel()
    keys, where = np.unique(pairs, return_inverse=True)
    gather = sparse.csc_array(
        (np.ones(len(pairs)), where, np.arange(len(pairs) + 1)), shape=(len(keys), len(pairs))
    ).tocsr()
    columns = keys % nodes
    starts = np.searchsorted(keys, np.arange(nodes + 1) * nodes)

    blocks = (gather @ stiffness.reshape(-1, 9)).reshape(-1, 3, 3)
    # The transpose of a symmetric CSR matrix is the CSC matrix that CHOLMOD wants.
    k = sparse.bsr_matrix((blocks, columns, starts)).tocsr().T

    mass = gather @ (DENSITY * volumes[:, None, None] * element_mass()).ravel()
    scalar = sparse.csr_matrix((mass, columns, starts))
    at = [np.flatnonzero(np.abs(points - point).max(axis=1) < 1e-6).item() for point in POINTS]
    lumped = np.zeros(nodes)
    lumped[at] = POINT_MASS
    m = sparse.kron(scalar + sparse.diags(lumped), sparse.eye(3), format="csc")
    return k, m


mesh = meshio.read(sys.argv[1])
points, tets = mesh.points, mesh.cells_dict["tetra10"].astype(np.int64)
check_order(points, tets)
laps.append(("mesh", time.perf_counter()))

k, m = assemble(points, tets)
laps.append(("assembly", time.perf_counter()))

# Of CHOLMOD's orderings AMD gives the least time in all here: METIS costs more than its factor saves.
factor = cholesky((k + SHIFT * m).tocsc(), ordering_method="amd")
laps.append(("factor", time.perf_counter()))

inverse = LinearOperator(k.shape, matvec=factor, dtype=float)
eigenvalues = eigsh(k, RIGID + FLEXIBLE, m, sigma=-SHIFT, OPinv=inverse)[0]
laps.append(("eigsh", time.perf_counter()))

eigenvalues.sort()
times = {name: end - begin for (_, begin), (name, end) in zip(laps, laps[1:])}
times["total"] = laps[-1][1] - laps[0][1]

# The libraries outside the Python packages, by name: which CHOLMOD, and whether its BLAS is a fast one.
with open("/proc/self/maps") as maps:
    loaded = {Path(line.split()[-1]) for line in maps if "/" in line and "site-packages" not in line}
wanted = ("libcholmod", "libblas", "libopenblas")
libraries = sorted(f"{file.parent.name}/{file.name}" for file in loaded if file.name.startswith(wanted))

print(
    json.dumps(
        {
            "nodes": len(points),
            "unknowns": k.shape[0],
            "natural_frequencies": (np.sqrt(eigenvalues[RIGID:]) / (2 * np.pi)).tolist(),
            "rigid_eigenvalues": eigenvalues[:RIGID].tolist(),
            "times": times,
            "versions": {
                "numpy": np.__version__,
                "scipy": scipy.__version__,
                "scikit-sparse": sksparse.__version__,
                "meshio": meshio.__version__,
            },
            "libraries": libraries,
        },
        indent=1,
    )
)
