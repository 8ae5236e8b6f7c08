"""Frequencies of free bodies of ten-node tetrahedra, by a code of its own: 64 points in each element, dense where rigid parts are tied."""

import itertools

import numpy as np
import scipy.linalg
import scipy.sparse as sparse
import scipy.sparse.linalg

# Ends of the edges, in the order of their nodes.
EDGES = [(0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3)]


def points_of_integration():
    at, weights = np.polynomial.legendre.leggauss(4)
    at, weights = (at + 1) / 2, weights / 2
    for i, j, k in itertools.product(range(4), repeat=3):
        a = at[i]
        b = at[j] * (1 - a)
        yield (a, b, at[k] * (1 - a - b)), weights[i] * weights[j] * weights[k] * (1 - a) * (1 - a - b)


def matrices(points, tetrahedra, young, poisson, density):
    """Stiffness and mass of a body."""
    lame, shear = young * poisson / ((1 + poisson) * (1 - 2 * poisson)), young / (2 * (1 + poisson))
    elasticity = np.diag([lame + 2 * shear] * 3 + [shear] * 3)
    elasticity[:3, :3] += lame * (1 - np.eye(3))
    count, corners = len(tetrahedra), points[tetrahedra]
    stiffness, mass = np.zeros((count, 30, 30)), np.zeros((count, 10, 10))
    slope = np.array([[-1, -1, -1], [1, 0, 0], [0, 1, 0], [0, 0, 1]], dtype=float)
    for (a, b, c), weight in points_of_integration():
        part = np.array([1 - a - b - c, a, b, c])
        shape = np.array([*(part * (2 * part - 1)), *(4 * part[i] * part[j] for i, j in EDGES)])
        slopes = np.vstack([(4 * part - 1)[:, None] * slope, [4 * (part[i] * slope[j] + part[j] * slope[i]) for i, j in EDGES]])
        jacobian = np.einsum("eni,nj->eij", corners, slopes)
        volume = np.linalg.det(jacobian) * weight
        along = np.einsum("nj,eji->eni", slopes, np.linalg.inv(jacobian))
        strain = np.zeros((count, 6, 30))
        for row, pairs in enumerate([[(0, 0)], [(1, 1)], [(2, 2)], [(0, 1), (1, 0)], [(1, 2), (2, 1)], [(0, 2), (2, 0)]]):
            for of, by in pairs:
                strain[:, row, of::3] = along[:, :, by]
        stiffness += np.einsum("eki,kl,elj,e->eij", strain, elasticity, strain, volume)
        mass += density * volume[:, None, None] * np.outer(shape, shape)
    dofs = (3 * tetrahedra[:, :, None] + np.arange(3)).reshape(count, 30)
    places = np.repeat(dofs, 30, axis=1).ravel(), np.tile(dofs, (1, 30)).ravel()
    of_three = np.einsum("eij,kl->eikjl", mass, np.eye(3)).reshape(count, 30, 30)
    return tuple(sparse.coo_matrix((each.ravel(), places)).tocsr() for each in (stiffness, of_three))


def turned(offset):
    """The displacements of a point by small turns about another."""
    x, y, z = offset
    return np.array([[0, z, -y], [-z, 0, x], [y, -x, 0]])


def frequencies(points, tetrahedra, material, rigid=None, carried=None, count=3):
    """Mass and the first frequencies of a free body. `rigid`: its nodes, the point and the mass on it; `carried`: the same of nodes whose
    mean motion, by least squares, moves the mass."""
    stiffness, mass = matrices(points, tetrahedra, *material)
    own = mass.sum() / 3
    if rigid:
        nodes, point, more = rigid
        free = np.setdiff1d(np.arange(len(points)), nodes)
        to = np.zeros((3 * len(points), 3 * len(free) + 6))
        for column, node in enumerate(free):
            to[3 * node : 3 * node + 3, 3 * column : 3 * column + 3] = np.eye(3)
        for node in nodes:
            to[3 * node : 3 * node + 3, -6:] = np.hstack([np.eye(3), turned(points[node] - point)])
        stiffness, mass = to.T @ (stiffness @ to), to.T @ (mass @ to)
        mass[-6:-3, -6:-3] += more * np.eye(3)
        found = scipy.linalg.eigh(stiffness, mass, eigvals_only=True)
    elif carried:
        nodes, point, more = carried
        mean = points[nodes].mean(axis=0)
        fit = np.vstack([np.hstack([np.eye(3), turned(points[node] - mean)]) for node in nodes])
        at_point = np.hstack([np.eye(3), turned(point - mean)]) @ np.linalg.pinv(fit)
        to = np.zeros((3, 3 * len(points)))
        to[:, (3 * np.array(nodes)[:, None] + np.arange(3)).ravel()] = at_point
        found = scipy.linalg.eigh(stiffness.toarray(), mass.toarray() + more * to.T @ to, eigvals_only=True)
    else:
        found = scipy.sparse.linalg.eigsh(stiffness, 6 + count, M=mass, sigma=-1e6, which="LM")[0]
    more = (rigid or carried or (0, 0, 0.0))[2]
    return own + more, np.sqrt(np.sort(found)[6 : 6 + count]) / (2 * np.pi)
