"""K and M of a scene's free body, assembled by NumPy: what the peers' eigensolvers are given.

A second implementation that shares nothing with flexframe: meshio reads the mesh, the integrals are the textbook's.
"""

import sys
import tomllib
from pathlib import Path

import meshio
import numpy as np
import scipy.sparse as sparse

# The corners that each mid-edge node lies between, in VTK's order, into which meshio brings gmsh's.
EDGES = np.array([[0, 1], [1, 2], [0, 2], [0, 3], [1, 3], [2, 3]])


class Body:
    """The mesh, material and point masses that a scene names."""

    def __init__(self, scene):
        body = tomllib.loads(Path(scene).read_text())["body"]
        mesh = meshio.read(Path(scene).parent / body["mesh"])
        self.points, self.tets = mesh.points, mesh.cells_dict["tetra10"].astype(np.int64)
        self.material = body["material"]
        self.point_masses = [(self.node_at(mass["at"]), mass["mass"]) for mass in body.get("point_masses", [])]
        middle = self.points[self.tets[:, EDGES]].mean(axis=2)
        if not np.allclose(self.points[self.tets[:, 4:]], middle, rtol=0, atol=1e-6):
            sys.exit(f"{scene}: mid-edge nodes are not in the order 01, 12, 02, 03, 13, 23, or the elements are curved")

    def node_at(self, point):
        return np.flatnonzero(np.abs(self.points - point).max(axis=1) < 1e-6).item()

    def sort_along_x(self):
        """Numbers the nodes along x, so that the elements around a range of nodes are few more than its own."""
        order = np.argsort(self.points[:, 0], kind="stable")
        number = np.empty_like(order)
        number[order] = np.arange(len(order))
        self.points, self.tets = self.points[order], number[self.tets]
        self.point_masses = [(number[node], mass) for node, mass in self.point_masses]


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


def element_stiffness(gradients, volumes, young, poisson):
    """K_ab = ∫ λ ∇Na ⊗ ∇Nb + μ (∇Nb ⊗ ∇Na + ∇Na·∇Nb 1), as e×10×10×3×3."""
    lame = young * poisson / ((1 + poisson) * (1 - 2 * poisson))
    shear = young / (2 * (1 + poisson))
    elements = len(volumes)
    # ∫ ∇Na ⊗ ∇Nb as one product of 30×4 by 4×30 in each element.
    weighted = (gradients * np.sqrt(volumes / 4)[:, None, None, None]).reshape(elements, 4, 30)
    outer = np.matmul(weighted.transpose(0, 2, 1), weighted).reshape(elements, 10, 3, 10, 3)
    outer = outer.transpose(0, 1, 3, 2, 4)
    stiffness = lame * outer + shear * outer.swapaxes(3, 4)
    stiffness[..., range(3), range(3)] += shear * np.trace(outer, axis1=3, axis2=4)[..., None]
    return stiffness


def assemble(body, first=0, last=None):
    """The rows of K and M (CSR, both symmetric as a whole) that belong to the nodes `first..last`."""
    nodes = len(body.points)
    last = nodes if last is None else last
    tets = body.tets[((body.tets >= first) & (body.tets < last)).any(axis=1)]
    edges = body.points[tets[:, 1:4]] - body.points[tets[:, :1]]
    volumes = np.linalg.det(edges) / 6
    inner = np.linalg.inv(edges).transpose(0, 2, 1)
    corner_gradients = np.concatenate([-inner.sum(axis=1, keepdims=True), inner], axis=1)
    young, poisson, density = (body.material[key] for key in ("young_modulus", "poisson_ratio", "density"))
    stiffness = element_stiffness(shape_gradients(corner_gradients), volumes, young, poisson)

    # The pattern is that of the nodes: sorting 100 pairs an element instead of 900 entries.
    pairs = (tets[:, :, None] * nodes + tets[:, None, :]).ravel()
    keys, where = np.unique(pairs, return_inverse=True)
    gather = sparse.csc_array(
        (np.ones(len(pairs)), where, np.arange(len(pairs) + 1)), shape=(len(keys), len(pairs))
    ).tocsr()
    begin, end = np.searchsorted(keys, [first * nodes, last * nodes])
    columns = (keys % nodes)[begin:end]
    starts = np.searchsorted(keys, np.arange(first, last + 1) * nodes) - begin

    blocks = (gather @ stiffness.reshape(-1, 9))[begin:end].reshape(-1, 3, 3)
    k = sparse.bsr_matrix((blocks, columns, starts), shape=(3 * (last - first), 3 * nodes)).tocsr()

    mass = (gather @ (density * volumes[:, None, None] * element_mass()).ravel())[begin:end]
    scalar = sparse.csr_matrix((mass, columns, starts), shape=(last - first, nodes))
    mine = [(node, mass) for node, mass in body.point_masses if first <= node < last]
    if mine:
        at, lumped = np.array([node for node, _ in mine]), [mass for _, mass in mine]
        scalar = scalar + sparse.csr_matrix((lumped, (at - first, at)), shape=scalar.shape)
    return k, sparse.kron(scalar, sparse.eye(3), format="csr")


def frequencies(eigenvalues):
    """Hz of the flexible modes, the six rigid ones left out."""
    return (np.sqrt(np.sort(eigenvalues)[6:]) / (2 * np.pi)).tolist()
