"""Small decks of the kinds that people have, each with its mass and three frequencies by two other programs: CalculiX and `elements.py`.

    python make.py FOLDER PAGE      (needs numpy, scipy, meshio, h5py and ccx)

Writes the decks and `numbers.csv` into the folder, in which `lug.msh` is, and the table into the page.
"""

import itertools
import pathlib
import subprocess
import sys
import tempfile

import h5py
import meshio
import numpy as np
from scipy.io import netcdf_file

from elements import EDGES, frequencies

STEEL = (210e3, 0.3, 7.85e-9)
ALUMINIUM_IN_INCHES = (1.0e7, 0.33, 2.54e-4)
GRAVITY_IN_INCHES = 386.09
# A mass on the rigid hole of the lug, on the same nodes by their mean.
HUB = np.array([50.0, 10.0, 4.0])
HUB_MASS = 2e-5
# A mass off the flat face at the root, on its nodes.
OFF = np.array([-12.0, 14.0, 9.0])
OFF_MASS = 3e-5

# The line under the head of the table.
RULE = "|---|---|---|---|---|---|---|\n"

folder, page = map(pathlib.Path, sys.argv[1:3])


class Body:
    def __init__(self, points, tetrahedra):
        self.points, self.tetrahedra = np.asarray(points, dtype=float), np.asarray(tetrahedra)

    def at(self, is_in):
        return [node for node, x in enumerate(self.points) if is_in(x)]


def lug():
    mesh = meshio.read(folder / "lug.msh")
    tetrahedra = np.vstack([block.data for block in mesh.cells if block.type == "tetra10"])
    return checked(mesh.points, tetrahedra)


def checked(points, tetrahedra):
    """The body with the nodes on its edges in the order 01 12 02 03 13 23, found by their places."""
    ordered = []
    for nodes in tetrahedra:
        corners, rest = nodes[:4], list(nodes[4:])
        middles = [(points[corners[a]] + points[corners[b]]) / 2 for a, b in EDGES]
        ordered.append([*corners, *(min(rest, key=lambda node: np.linalg.norm(points[node] - x)) for x in middles)])
    used = np.unique(ordered)
    numbers = np.zeros(len(points), dtype=int)
    numbers[used] = np.arange(len(used))
    return Body(points[used], numbers[np.array(ordered)])


def lattice(counts, place):
    """Bricks of six tetrahedra each, with their nodes on a lattice. Returns the body and the lattice's coordinates of its nodes."""
    shape = [2 * count + 1 for count in counts]
    number = lambda at: (at[0] * shape[1] + at[1]) * shape[2] + at[2]
    places = np.array(list(itertools.product(*(range(n) for n in shape))))
    tetrahedra = []
    for brick in itertools.product(*map(range, counts)):
        for axes in itertools.permutations(range(3)):
            corners = [2 * np.array(brick)]
            for axis in axes:
                corners.append(corners[-1] + 2 * np.eye(3, dtype=int)[axis])
            if np.linalg.det(np.array(corners[1:]) - corners[0]) < 0:
                corners[1], corners[2] = corners[2], corners[1]
            edges = [(corners[a] + corners[b]) // 2 for a, b in EDGES]
            tetrahedra.append([number(at) for at in [*corners, *edges]])
    scaled = places / (np.array(shape) - 1)
    return Body([place(at) for at in scaled], tetrahedra), scaled


# The quarter of a ring between the radii 60 and 70, 10 high: read as a bar of 10 x 90 x 10 it has 6300 Hz.
def polar(at):
    return np.array([60 + 10 * at[0], 90 * at[1], 10 * at[2]])


def bent(at):
    radius, degrees, height = polar(at)
    return np.array([radius * np.cos(np.radians(degrees)), radius * np.sin(np.radians(degrees)), height])


# Nastran


def short(value):
    """A number in eight letters, as preprocessors write it."""
    text = f"{value:.5f}"[:8]
    return text if abs(value) >= 1e-12 else "0."


def real(value):
    return repr(float(value))


def cards(name, fields, width=8, label=None):
    """A card in short or wide fields; the lines that continue it are marked, by their label where there is one."""
    star, count = ("*", 4) if width == 16 else ("", 8)
    lines = [fields[at : at + count] for at in range(0, len(fields), count)]
    text = ""
    for number, line in enumerate(lines):
        head = f"{name}{star}" if number == 0 else f"{star or '+'}{label or ''}"
        text += f"{head:8}" + "".join(f"{field:>{width}}" for field in map(str, line))
        if label and number + 1 < len(lines):
            text += " " * (width * (count - len(line))) + f"{star or '+'}{label}"
        text += "\n"
    return text


def comma(name, fields):
    lines = [fields[at : at + 8] for at in range(0, len(fields), 8)]
    return f"{name}," + "\n,".join(",".join(map(str, line)) for line in lines) + "\n"


def nastran(body, write, number, material=STEEL, system="", of=None):
    """Nodes, elements of property 1 and its material."""
    points = body.points if of is None else of
    text = "".join(write("GRID", [node, system, *map(number, x)]) for node, x in enumerate(points, 1))
    for element, nodes in enumerate(body.tetrahedra, 1):
        text += write("CTETRA", [element, 1, *(nodes + 1)])
    return text + material_cards(write, material)


def material_cards(write, material):
    digits = lambda value: next(text for n in range(1, 17) if float(text := f"{value:.{n}e}") == value)
    small = lambda value: digits(value).replace("e-0", "-").replace("e+0", "+")
    young, poisson, density = material
    return write("PSOLID", [1, 5]) + write("MAT1", [5, small(young), "", poisson, small(density)])


def of_nastran(body, ring, at):
    free = lambda name, fields: comma(name, fields)
    short_cards = lambda name, fields: cards(name, fields)
    wide = lambda name, fields: cards(name, fields, 16)
    head = "SOL 103\nCEND\nTITLE = LUG\nMETHOD = 1\nBEGIN BULK\nEIGRL,1,,,10\n"
    numbers = itertools.count(1)
    labelled = lambda name, fields: cards(name, fields, label=f"E{next(numbers):06d}")
    plain = nastran(body, labelled, short)
    # Sorted as old programs do it: the lines that continue are at the end.
    lines = plain.splitlines(keepends=True)
    apart = "".join(sorted(line for line in lines if line[0] != "+")) + "".join(sorted(line for line in lines if line[0] == "+"))
    blank = nastran(body, free, lambda value: "" if abs(value) < 1e-12 else real(value)).lower()
    blank_nodes, blank_elements = blank[: blank.index("ctetra")], blank[blank.index("ctetra") :]
    inches = Body(body.points / 25.4, body.tetrahedra)
    weight = nastran(inches, free, lambda value: f"{value:.9f}", (1.0e7, 0.33, 2.54e-4 * GRAVITY_IN_INCHES))
    weight = weight.replace("PSOLID", f"$ Femap Property 1 : Lug of aluminium\nPARAM,WTMASS,{1 / GRAVITY_IN_INCHES!r}\nPSOLID", 1)
    cord = "CORD2C,3,,0.,0.,0.,0.,0.,1.\n,1.,0.,0.\n"
    repeated = "GRDSET,,3\n"
    body_of_ring, scaled = ring
    for first in range(0, len(scaled), 3):
        radius, degrees, height = polar(scaled[first])
        repeated += f"GRID,{first + 1},,{radius},{degrees},{height}\n=,*(1),=,=,=,*(5.)\n=1\n"
    rest = "".join(free("CTETRA", [e, 1, *(nodes + 1)]) for e, nodes in enumerate(body_of_ring.tetrahedra, 1))
    hole = [node + 1 for node in at["hole"]]
    count = len(body.points)
    hub = free("GRID", [count + 1, "", *map(real, HUB)]) + free("CONM2", [9001, count + 1, "", HUB_MASS])
    rigid = hub + free("RBE2", [9002, count + 1, 123456, *hole])
    mean = hub + free("RBE3", [9003, "", count + 1, 123456, "1.", 123, *hole])
    # The mass has an offset from its node, which is off the face, too.
    node, offset = OFF - [3.0, 0.0, 1.0], ["3.", "", "1."]
    root = [node + 1 for node in at["root"]]
    off = free("GRID", [count + 1, "", *map(real, node)]) + free("CONM2", [9001, count + 1, "", OFF_MASS, *offset])
    rigid_off = off + free("RBE2", [9002, count + 1, 123456, *root])
    mean_off = off + free("RBE3", [9003, "", count + 1, 123456, "1.", 123, *root])
    beside = "".join(free(*card) for card in [("CBAR", [9004, 7, 1, 2, "0.", "0.", "1."]), ("PBAR", [7, 5, "2."]), ("CMASS2", [9005, "1.-6", 3, 1])])
    skin = free("CTRIA3", [9006, 8, 1, 2, 3]) + free("PSHELL", [8, 5, ".5", "", "", "", "", "1.-9"])
    return {
        "nastran_short.bdf": head + nastran(body, short_cards, short) + "ENDDATA\n",
        "nastran_wide.bdf": head + nastran(body, wide, lambda value: f"{value:.10g}") + "ENDDATA\n",
        "nastran_free.nas": nastran(body, free, real),
        "nastran_apart.bdf": head + apart + "ENDDATA\n",
        "nastran_blank.bdf": "$ no ENDDATA\ninclude 'nastran_nodes.inc'\n" + blank_elements,
        "nastran_nodes.inc": blank_nodes,
        "nastran_inch.fem": head + weight + "ENDDATA\n",
        "nastran_ring.bdf": cord + nastran(body_of_ring, wide, lambda value: f"{value:.10g}", system=3, of=[polar(x) for x in scaled]),
        "nastran_replicated.bdf": cord + repeated + rest + material_cards(free, STEEL),
        "nastran_rbe2.bdf": nastran(body, free, real) + rigid + beside + skin,
        "nastran_rbe3.bdf": nastran(body, free, real) + mean,
        "nastran_rbe2_off.bdf": nastran(body, free, real) + rigid_off,
        "nastran_rbe3_off.bdf": nastran(body, free, real) + mean_off,
    }


# Abaqus and CalculiX


def lines(of):
    return "".join(",".join(map(str, row)) + "\n" for row in of)


def listed(nodes):
    return "".join(", ".join(map(str, nodes[at : at + 16])) + ",\n" for at in range(0, len(nodes), 16))


MATERIAL = "*Material, name=Steel\n*Density\n 7.85e-09,\n*Elastic\n210000., 0.3\n"


def of_abaqus(body, at):
    count = len(body.points)
    nodes = lines([node, *map(real, x)] for node, x in enumerate(body.points, 1))
    elements = lines([number, *(row + 1)] for number, row in enumerate(body.tetrahedra, 1))
    root, tip = ([node + 1 for node in at[name]] for name in ("root", "hole"))
    cae = (
        "*Heading\n** Job name: lug Model name: Model-1\n*Preprint, echo=NO, model=NO\n**\n** PARTS\n**\n*Part, name=Lug\n"
        f"*Node\n{nodes}*Element, type=C3D10\n{elements}*Nset, nset=Set-1\n{listed(root)}"
        f"*Nset, nset=Set-2, generate\n1, {count}, 1\n*Elset, elset=Set-2, generate\n1, {len(body.tetrahedra)}, 1\n"
        "** Section: Section-1\n*Solid Section, elset=Set-2, material=Steel\n,\n*End Part\n**\n** ASSEMBLY\n**\n*Assembly, name=Assembly\n**\n"
        "*Instance, name=Lug-1, part=Lug\n10., 0., 0.\n10., 0., 0., 10., 0., 1., 30.\n*End Instance\n**\n*Node\n1, 60., 10., 4.\n"
        f"*Nset, nset=Set-1, instance=Lug-1\n{listed(tip)}*Nset, nset=RP\n1,\n*End Assembly\n{MATERIAL}"
        "*Step, name=Step-1, perturbation\n*Frequency, eigensolver=Lanczos\n10, , , , ,\n*Restart, write, frequency=0\n*Output, field, variable=PRESELECT\n*End Step\n"
    )
    # As ccx's own examples: fields that are left out, exponents with a D, node sets that hold the body.
    field = lambda value: "" if value == 0.0 else f"{value:.12E}".replace("E", "D")
    bare = lines([node, *map(field, x)] for node, x in enumerate(body.points, 1)).replace(",\n", "\n").replace(",\n", "\n")
    halves = lines([number, *(row[:5] + 1), "\n" + str(row[5] + 1), *(row[6:] + 1)] for number, row in enumerate(body.tetrahedra, 1))
    calculix = (
        f"**\n*NODE,NSET=Nall\n{bare}*ELEMENT,TYPE=C3D10,ELSET=Eall\n{halves}*NSET,NSET=FIX\n{listed(root)}"
        f"{MATERIAL.upper()}*SOLIDSECTION,ELSET=Eall,MATERIAL=STEEL\n*STEP\n*FREQUENCY\n10\n*END STEP\n"
    )
    x, y, z = OFF
    off = (
        f"*NODE, NSET=Nall\n{nodes}{count + 1}, {x}, {y}, {z}\n*ELEMENT, TYPE=C3D10, ELSET=Eall\n{elements}"
        f"*NSET, NSET=root\n{listed(root)}*SURFACE, NAME=face, TYPE=NODE\nroot,\n"
        f"*COUPLING, REF NODE={count + 1}, SURFACE=face, CONSTRAINT NAME=c\n*KINEMATIC\n1, 6\n*ELEMENT, TYPE=MASS, ELSET=hub\n90001, {count + 1}\n"
        f"*MASS, ELSET=hub\n{OFF_MASS}\n{MATERIAL}*SOLID SECTION, ELSET=Eall, MATERIAL=Steel\n"
    )
    x, y, z = HUB
    rigid = (
        f"*NODE, NSET=Nall\n{nodes}{count + 1}, {x}, {y}, {z}\n*ELEMENT, TYPE=C3D10, ELSET=Eall\n{elements}"
        f"*NSET, NSET=hole\n{listed(tip)}*RIGID BODY, NSET=hole, REF NODE={count + 1}\n*ELEMENT, TYPE=MASS, ELSET=hub\n90001, {count + 1}\n"
        f"*MASS, ELSET=hub\n{HUB_MASS}\n{MATERIAL}*SOLID SECTION, ELSET=Eall, MATERIAL=Steel\n"
    )
    return {"abaqus_cae.inp": cae, "calculix.inp": calculix, "calculix_rigid.inp": rigid, "abaqus_coupling_off.inp": off}


# Universal, MED, Exodus, VTK


def universal(body, at):
    ten = lambda numbers: "".join("".join(f"{n:>10}" for n in numbers[i : i + 8]) + "\n" for i in range(0, len(numbers), 8))
    dataset = lambda number, text: f"    -1\n{number:>6}\n{text}    -1\n"
    number = lambda value: f"{value:25.16E}".replace("E", "D")
    nodes = "".join(ten([node, 1, 1, 11]) + "".join(map(number, x)) + "\n" for node, x in enumerate(body.points, 1))
    elements = ""
    for label, n in enumerate(body.tetrahedra + 1, 1):
        # Corners and nodes on edges in turn around each layer.
        elements += ten([label, 118, 2, 1, 7, 10]) + ten([n[k] for k in (0, 4, 1, 5, 2, 6, 7, 8, 9, 3)])
    groups = ""
    for label, (name, kind, members) in enumerate([("lug", 8, range(len(body.tetrahedra))), ("root", 7, at["root"])], 1):
        flat = [word for member in members for word in (kind, member + 1, 0, 0)]
        groups += ten([label, 0, 0, 0, 0, 0, 0, len(flat) // 4]) + f"{name}\n" + ten(flat)
    units = "         1         SI: Millimeter (newton)         2\n    1.0000000000000000D+03    1.0000000000000000D+00    1.0000000000000000D+00\n    2.7314999999999998D+02\n"
    return dataset(164, units) + dataset(2411, nodes) + dataset(2412, elements) + dataset(2467, groups)


def exodus(path, body, at):
    def name(text):
        array = np.zeros((1, 33), dtype="S1")
        array[0, : len(text)] = list(text)
        return array

    connect = (body.tetrahedra + 1).astype("i4")
    variables = {f"coord{axis}": (body.points[:, i], ["num_nodes"]) for i, axis in enumerate("xyz")}
    variables |= {
        "eb_names": (name("lug"), ["num_el_blk", "len_name"]),
        "eb_prop1": (np.array([1], dtype="i4"), ["num_el_blk"]),
        "connect1": (connect, ["num_el_in_blk1", "num_nod_per_el1"]),
        "ns_names": (name("root"), ["num_node_sets", "len_name"]),
        "ns_prop1": (np.array([1], dtype="i4"), ["num_node_sets"]),
        "node_ns1": (np.array(at["root"], dtype="i4") + 1, ["num_nod_ns1"]),
    }
    with netcdf_file(path, "w", version=2) as file:
        for key, (array, dimensions) in variables.items():
            for dimension, size in zip(dimensions, array.shape):
                if dimension not in file.dimensions:
                    file.createDimension(dimension, size)
            variable = file.createVariable(key, "c" if array.dtype.kind == "S" else array.dtype, dimensions)
            variable[:] = array
            if key == "connect1":
                variable.elem_type = "TETRA10"


def of_meshio(body, at):
    label = [np.full(len(body.tetrahedra), 3)]
    mesh = meshio.Mesh(body.points, [("tetra10", body.tetrahedra)], cell_data={"material": label})
    meshio.write(folder / "lug.vtu", mesh)
    meshio.write(folder / "lug.xdmf", mesh)
    # Salome has the corners in the order 0 2 1 3.
    turned = body.tetrahedra[:, [0, 2, 1, 3, 6, 5, 4, 7, 9, 8]]
    salome = meshio.Mesh(body.points, [("tetra10", turned)], cell_data={"cell_tags": [np.full(len(turned), -6)]})
    salome.cell_tags, salome.point_tags = {-6: ["lug"]}, {2: ["root"]}
    salome.point_data = {"point_tags": np.where(np.isin(np.arange(len(body.points)), at["root"]), 2, 0)}
    salome.write(folder / "salome.med")
    # With filters the file is half as large.
    repack = folder / "salome.h5"
    with h5py.File(folder / "salome.med") as old, h5py.File(repack, "w") as new:
        new.attrs.update(old.attrs)
        for key in old:
            old.copy(key, new)
    repack.replace(folder / "salome.med")


def by_calculix(body, material, tied=None):
    """The first frequencies of the free body."""
    young, poisson, density = material
    count = len(body.points)
    nodes = lines([node, *(f"{value:.12e}" for value in x)] for node, x in enumerate(body.points, 1))
    elements = lines([number, *(row + 1)] for number, row in enumerate(body.tetrahedra, 1)).replace(",", ", ")
    text = f"*NODE,NSET=N\n{nodes}*ELEMENT,TYPE=C3D10,ELSET=E\n{elements}"
    if tied:
        hole, (x, y, z), mass = tied
        text += f"*NODE\n{count + 1},{x},{y},{z}\n{count + 2},{x},{y},{z}\n*NSET,NSET=H\n{listed([node + 1 for node in hole])}"
        text += f"*RIGID BODY,NSET=H,REF NODE={count + 1},ROT NODE={count + 2}\n"
        text += f"*ELEMENT,TYPE=MASS,ELSET=M\n{len(body.tetrahedra) + 1},{count + 1}\n*MASS,ELSET=M\n{mass}\n"
    text += f"*MATERIAL,NAME=M\n*ELASTIC\n{young},{poisson}\n*DENSITY\n{density}\n*SOLID SECTION,ELSET=E,MATERIAL=M\n"
    return frequencies_of(text + "*STEP\n*FREQUENCY\n12\n*END STEP\n")


def frequencies_of(text):
    """The first frequencies of the free body of a deck for CalculiX."""
    with tempfile.TemporaryDirectory() as place:
        (pathlib.Path(place) / "job.inp").write_text(text)
        subprocess.run(["ccx", "job"], cwd=place, check=True, stdout=subprocess.DEVNULL)
        rows = (pathlib.Path(place) / "job.dat").read_text().split("E I G E N V A L U E")[1].splitlines()
    # Number, eigenvalue, two frequencies and an imaginary part.
    found = [float(row.split()[3]) for row in rows if row.split() and row.split()[0].isdigit() and len(row.split()) >= 4]
    return [value for value in found if value > 10.0][:3]


def main():
    body = lug()
    at = {"root": body.at(lambda x: abs(x[0]) < 1e-6), "hole": body.at(lambda x: abs(np.hypot(x[0] - 50, x[1] - 10) - 5) < 0.5)}
    ring = lattice((1, 9, 1), bent)
    texts = of_nastran(body, ring, at) | of_abaqus(body, at) | {"salome.unv": universal(body, at)}
    for name, text in texts.items():
        (folder / name).write_text(text)
    of_meshio(body, at)
    exodus(folder / "lug.exo", body, at)

    inches = Body(body.points / 25.4, body.tetrahedra)
    hub = (at["hole"], HUB, HUB_MASS)
    plain = (frequencies(body.points, body.tetrahedra, STEEL), by_calculix(body, STEEL))
    in_ring = (frequencies(ring[0].points, ring[0].tetrahedra, STEEL), by_calculix(ring[0], STEEL))
    in_inches = (frequencies(inches.points, inches.tetrahedra, ALUMINIUM_IN_INCHES), by_calculix(inches, ALUMINIUM_IN_INCHES))
    rigid = (frequencies(body.points, body.tetrahedra, STEEL, rigid=hub), by_calculix(body, STEEL, hub))
    off = (at["root"], OFF, OFF_MASS)
    rigid_off = (frequencies(body.points, body.tetrahedra, STEEL, rigid=off), by_calculix(body, STEEL, off))
    mean_off = (frequencies(body.points, body.tetrahedra, STEEL, carried=off), None)
    mean = (frequencies(body.points, body.tetrahedra, STEEL, carried=hub), None)
    numbers = {
        "lug.msh": (plain, "gmsh, MSH 4.1"),
        "salome.med": (plain, "Salome: corners 0 2 1 3, families"),
        "salome.unv": (plain, "Salome: datasets 2411, 2412 and groups in 2467"),
        "abaqus_cae.inp": (plain, "Abaqus/CAE: a part, its instance moved and turned, a reference point with the number of a node, one name in two scopes"),
        "calculix.inp": (plain, "CalculiX: fields left out, exponents with D, two lines an element, node sets"),
        "calculix_rigid.inp": (rigid, "CalculiX: `*RIGID BODY` with a `*MASS` on its node"),
        "nastran_short.bdf": (plain, "Nastran: short fields, case control"),
        "nastran_wide.bdf": (plain, "Nastran: wide fields"),
        "nastran_free.nas": (plain, "Nastran: free fields, bulk data alone"),
        "nastran_apart.bdf": (plain, "Nastran: sorted, continuations apart from their cards"),
        "nastran_blank.bdf": (plain, "Nastran: blank fields, small letters, `INCLUDE`, no `ENDDATA`"),
        "nastran_inch.fem": (in_inches, "Nastran: inches, psi, densities by weight, `PARAM,WTMASS`, a name in a comment"),
        "nastran_ring.bdf": (in_ring, "Nastran: a quarter of a ring in a cylindrical system"),
        "nastran_replicated.bdf": (in_ring, "Nastran: the same by replication and `GRDSET`"),
        "nastran_rbe2.bdf": (rigid, "Nastran: `CONM2` on an `RBE2`, with bars, shells and a scalar mass beside it"),
        "nastran_rbe3.bdf": (mean, "Nastran: `CONM2` on an `RBE3`"),
        "nastran_rbe2_off.bdf": (rigid_off, "Nastran: `CONM2` with an offset, on the `RBE2` of a flat face with its point off it"),
        "nastran_rbe3_off.bdf": (mean_off, "Nastran: the same on an `RBE3`"),
        "abaqus_coupling_off.inp": (rigid_off, "Abaqus: the same by a kinematic `*COUPLING`"),
        "lug.exo": (plain, "Exodus: names of blocks and node sets"),
        "lug.vtu": (plain, "VTU"),
        "lug.xdmf": (plain, "XDMF with its data in HDF5 beside it"),
    }
    # CalculiX reads the deck of its own kind as it is.
    own = frequencies_of((folder / "calculix.inp").read_text())
    assert np.allclose(own, plain[1], rtol=1e-5), own
    rows, table = ["file,mass,first,second,third"], []
    for name, (((mass, own), calculix), what) in numbers.items():
        rows.append(f"{name},{mass:.8e}," + ",".join(f"{value:.6f}" for value in own))
        apart = "none" if calculix is None else f"{max(abs(a / b - 1) for a, b in zip(own, calculix)):.1e}"
        table.append(f"| `{name}` | {what} | {mass:.5e} | " + " | ".join(f"{value:.2f}" for value in own) + f" | {apart} |")
        print(name, mass, *own, "CalculiX:", calculix)
    (folder / "numbers.csv").write_text("\n".join(rows) + "\n")
    head, rest = page.read_text().split(RULE)
    page.write_text(head + RULE + "\n".join(table) + rest[rest.index("\n\n") :])


main()
