"""Reads a mesh with meshio (or meshlane) and writes its second-order tetrahedra with all named sets as MSH 4.1.

Arguments: the mesh file, the MSH file to write, and "raise" if first-order tetrahedra are to get mid-edge nodes.
Prints a line of JSON: what was left out ("notes"), or what is wrong ("error", with "help").
"""

import contextlib
import importlib
import io
import json
import struct
import sys
from collections import Counter
from pathlib import Path

# The private folder of this program: nothing in it hides a module.
sys.path.append(str(Path(__file__).parent))

from exodus import exodus  # noqa: E402

# The corners of each edge, and the edges in gmsh's order of the mid-edge nodes.
EDGES = {
    "tetra10": [(0, 1), (1, 2), (0, 2), (0, 3), (2, 3), (1, 3)],
    "triangle6": [(0, 1), (1, 2), (0, 2)],
}
RAISED = {"tetra": "tetra10", "triangle": "triangle6"}
CORNERS = {"tetra10": 4, "triangle6": 3}
# Elements of VTK that may have any order, by the number of their nodes.
OF_ANY_ORDER = {
    ("VTK_LAGRANGE_TETRAHEDRON", 4): "tetra",
    ("VTK_LAGRANGE_TETRAHEDRON", 10): "tetra10",
    ("VTK_LAGRANGE_TRIANGLE", 3): "triangle",
    ("VTK_LAGRANGE_TRIANGLE", 6): "triangle6",
}
# A node that is farther from the middle of its edge, in lengths of the longest edge, may be on another edge.
FAR = 0.25
XDMF = (".xdmf", ".xmf")
EXODUS = (".e", ".exo", ".ex2", ".g", ".gen")
HELP = "install it (pip install meshio h5py), or name a Python that has it in FLEXFRAME_PYTHON"


class Refused(Exception):
    def __init__(self, error, help):
        super().__init__(error)
        self.help = help


class File:
    """The parts of a file that are read: nodes, blocks of elements of one kind, and names."""

    def __init__(self, np, points, cells):
        self.points = np.asarray(points, dtype=float)
        self.cells = [(kind, np.asarray(nodes)) for kind, nodes in cells]
        self.element_sets = {}  # name: rows of each block
        self.node_sets = {}
        self.labels = {}  # name: whole numbers of each block
        self.names_of_labels = {}  # label array: {(number, dimension) or number: names}


def main(source, target, raise_order):
    try:
        import numpy as np
    except ImportError:
        raise Refused(f"{sys.executable} has no numpy", HELP)
    notes = []
    if Path(source).suffix.lower() in EXODUS:
        try:
            file = exodus(np, source, File, Refused, notes)
        except ImportError:
            raise Refused(f"{sys.executable} has no h5py", HELP)
        except (ValueError, KeyError, IndexError, struct.error, OSError) as error:
            raise Refused(f"it is no Exodus file that can be read: {in_words(error)}", "check the file, and write its mesh anew")
    else:
        if Path(source).suffix.lower() in XDMF:
            has_its_data(source)
        file = with_meshio(np, source)
    points = file.points
    if len(points) == 0:
        raise Refused("it has no nodes", "check the file")
    if points.ndim != 2 or points.shape[1] != 3:
        raise Refused(f"its nodes have {points.shape[-1]} coordinates", "write it in three dimensions")
    blocks = []  # kind, nodes, number of the block in the file
    others = Counter()
    for number, (kind, nodes) in enumerate(file.cells):
        kind = OF_ANY_ORDER.get((kind, nodes.shape[-1]), kind)
        if kind in RAISED and raise_order:
            kind = RAISED[kind]
            points, nodes = raised(np, points, nodes, kind, blocks)
        if kind in EDGES:
            blocks.append((kind, ordered(np, points, nodes, kind), number))
        else:
            others[kind] += len(nodes)
    solids = {kind: count for kind, count in others.items() if kind.startswith(("tetra", "hexa", "wedge", "pyramid"))}
    if "tetra" in solids:
        raise Refused(
            f"it has {solids['tetra']} tetrahedra of first order",
            "mesh with second-order elements, or set raise_order = true in [body] for straight edges with nodes in their middle",
        )
    if solids:
        each = ", ".join(f"{count} {kind}" for kind, count in solids.items())
        raise Refused(
            f"it has elements that are no tetrahedra: {each}",
            "mesh with ten-node tetrahedra (C3D10, tetra10), or give mass and stiffness of any elements in place of the mesh: "
            "`matrices` in [body], which CalculiX, Abaqus and others write (docs/reference/matrices.md)",
        )
    if not any(kind == "tetra10" for kind, _, _ in blocks):
        found = ", ".join(f"{count} {kind}" for kind, count in others.items()) or "no elements at all"
        raise Refused(f"it has no tetrahedra: {found}", "mesh the volume with ten-node tetrahedra")

    turned = turn(np, points, blocks)
    if turned:
        notes.append(f"all {turned} tetrahedra are mirrored or have their nodes the other way round, and are turned")

    groups = Groups(blocks)
    for name, rows in file.element_sets.items():
        groups.add(np, name, rows)
    for name, arrays in file.labels.items():
        add_labels(np, groups, name, arrays, file.names_of_labels.get(name), notes)
    point_sets = {name: nodes for name, nodes in file.node_sets.items() if len(nodes)}
    tell(notes, "element set", "no tetrahedra and no triangles of six nodes", groups.without)
    tell(notes, "node set", "no nodes", [name for name in file.node_sets if name not in point_sets])
    write(np, target, points, blocks, groups, point_sets)
    if others:
        count = sum(len(nodes) for kind, nodes, _ in blocks if kind == "tetra10")
        each = ", ".join(f"{number} {kind}" for kind, number in others.items())
        notes.append(f"read: {count} tetrahedra; not used: {each}")
    return {"notes": notes}


def tell(notes, kind, what, names):
    if names:
        shown = ", ".join(names[:5]) + (f" and {len(names) - 5} more" if len(names) > 5 else "")
        notes.append(f"the {kind} {shown} has {what}" if len(names) == 1 else f"the {kind}s {shown} have {what}")


def in_words(error):
    """An error of Python for those who have never seen one."""
    words = " ".join(str(error).split())
    if isinstance(error, KeyError):
        return f"a part of the format is not in it ({words})"
    if isinstance(error, FileNotFoundError):
        return f"a file with its data is not there ({words})"
    if isinstance(error, OSError):
        return f"a file is cut off, or is not of its format ({words})"
    if isinstance(error, (ValueError, IndexError, TypeError, struct.error)):
        return f"its numbers are not as many, or not of the kind, as it says ({words})"
    return words or type(error).__name__


def has_its_data(source):
    """Refuses a file of XDMF whose data are in others that are not there."""
    import xml.etree.ElementTree as xml

    try:
        items = list(xml.parse(source).iter("DataItem"))
    except xml.ParseError as error:
        raise Refused(f"it is no XML: {error}", "check the file: it may be cut off")
    for item in items:
        if item.get("Format", "").lower() in ("hdf", "hdf5", "binary") and item.text:
            name = item.text.strip().rpartition(":")[0] or item.text.strip()
            if not (Path(source).parent / name).is_file():
                raise Refused(f"its data are in {name}, which is not there", "put that file beside it, under this name")


def with_meshio(np, source):
    try:
        import meshio
    except ImportError:
        try:
            import meshlane as meshio
        except ImportError:
            raise Refused(f"{sys.executable} has neither meshio nor meshlane", HELP)
    said = io.StringIO()
    help = "check the file, or write it as VTU, .inp or MSH 4.1"
    try:
        # VTK and ParaView add texts of their own, which meshio would refuse.
        with contextlib.suppress(ImportError, AttributeError):
            vtu = importlib.import_module(f"{meshio.__name__}.vtu._vtu")
            vtu.vtu_to_numpy_type.setdefault("String", np.dtype("uint8"))
        # meshio prints its reasons.
        with contextlib.redirect_stdout(said), contextlib.redirect_stderr(said):
            mesh = meshio.read(source)
    except Refused:
        raise
    except MemoryError:
        raise
    except (SystemExit, Exception) as error:
        words = " ".join(said.getvalue().split()).removeprefix("Error:").strip()
        raise Refused(f"meshio cannot read it: {words or in_words(error)}", help)
    file = File(np, mesh.points, [(block.type, block.data) for block in mesh.cells])
    count = len(mesh.cells)
    for name, rows in mesh.cell_sets.items():
        if not name.startswith("gmsh:bounding_entities") and len(rows) == count:
            file.element_sets[name] = [[] if rows_of_block is None else rows_of_block for rows_of_block in rows]
    file.node_sets = dict(mesh.point_sets)
    for number, names in getattr(mesh, "point_tags", {}).items():
        nodes = np.flatnonzero(np.asarray(mesh.point_data["point_tags"]) == number)
        for name in names:
            file.node_sets[name] = np.concatenate([file.node_sets.get(name, []), nodes]).astype(int)
    file.labels = {name: arrays for name, arrays in mesh.cell_data.items() if name != "gmsh:geometrical"}
    # gmsh's physical groups have names by number and dimension, MED's families by number.
    physical = {(int(data[0]), int(data[1])): [name] for name, data in mesh.field_data.items() if len(data) == 2}
    file.names_of_labels = {"gmsh:physical": physical, "cell_tags": getattr(mesh, "cell_tags", {})}
    return file


def raised(np, points, nodes, kind, blocks):
    """Straight elements with a node in the middle of each edge, shared with those of other elements."""
    edges = np.array(EDGES[kind])
    ends = np.sort(nodes[:, edges].reshape(-1, 2), axis=1)
    # Edges of blocks before, whose mid-edge nodes are there.
    known = {}
    for other, there, _ in blocks:
        for (a, b), column in zip(EDGES[other], range(CORNERS[other], there.shape[1])):
            for i, j, middle in zip(there[:, a], there[:, b], there[:, column]):
                known[min(i, j), max(i, j)] = middle
    different, which = np.unique(ends, axis=0, return_inverse=True)
    numbers = np.empty(len(different), dtype=int)
    new = []
    for at, (i, j) in enumerate(different):
        middle = known.get((i, j))
        if middle is None:
            middle = len(points) + len(new)
            new.append((points[i] + points[j]) / 2)
        numbers[at] = middle
    if new:
        points = np.vstack([points, new])
    return points, np.hstack([nodes, numbers[which.reshape(-1)].reshape(len(nodes), -1)])


def ordered(np, points, nodes, kind):
    """The elements with their mid-edge nodes in gmsh's order, found from where the nodes are: formats differ."""
    corners = CORNERS[kind]
    edges = np.array(EDGES[kind])
    if len(nodes) == 0:
        return nodes
    middles = points[nodes[:, edges]].mean(axis=2)
    there = points[nodes[:, corners:]]
    nearest = np.linalg.norm(middles[:, :, None] - there[:, None, :], axis=3).argmin(axis=2)
    order = Counter(map(tuple, nearest.tolist())).most_common(1)[0][0]
    if sorted(order) != list(range(len(edges))):
        raise Refused(f"the nodes on the edges of its {kind} elements are not between their corners", "check the order of nodes")
    # In a sliver the middles of two edges are so near to each other that they are mistaken, which is no other order.
    ends = points[nodes[:, edges]]
    longest = np.linalg.norm(ends[:, :, 0] - ends[:, :, 1], axis=2).max(axis=1)
    far = np.linalg.norm(middles - there[:, list(order)], axis=2).max(axis=1) > FAR * longest
    wrong = np.flatnonzero((nearest != np.array(order)).any(axis=1) & far)
    if len(wrong):
        element = ", ".join(str(node + 1) for node in nodes[wrong[0]])
        raise Refused(
            f"{len(wrong)} of its {len(nodes)} {kind} elements have nodes on edges in another order than the others, the first "
            f"is that of the nodes {element} (counted from 1)",
            "check the order of nodes, or mesh again with less curved elements",
        )
    return np.hstack([nodes[:, :corners], nodes[:, corners:][:, list(order)]])


def turn(np, points, blocks):
    """Turns the tetrahedra if all of them have a negative volume, as those of MED have. Returns how many are turned."""
    count = 0
    for kind, nodes, _ in blocks:
        if kind == "tetra10" and len(nodes):
            corners = points[nodes[:, :4]]
            edges = corners[:, 1:] - corners[:, :1]
            if (np.linalg.det(edges) >= 0).any():
                return 0
            count += len(nodes)
    for _, nodes, _ in (block for block in blocks if block[0] == "tetra10"):
        # Corners 1 and 2 change places, and with them the nodes on the edges 01 and 02, 23 and 13.
        nodes[:] = nodes[:, [0, 2, 1, 3, 6, 5, 4, 7, 9, 8]]
    return count


class Groups:
    """For each element of each block, the names of the groups that it is in."""

    def __init__(self, blocks):
        self.of_block = {number: [() for _ in nodes] for _, nodes, number in blocks}
        self.kind = {number: kind for kind, _, number in blocks}
        self.without = []

    def add(self, np, name, rows):
        found = 0
        for number, rows_of_block in enumerate(rows):
            of_block = self.of_block.get(number)
            for row in np.asarray(rows_of_block, dtype=int).reshape(-1) if of_block is not None else []:
                if name not in of_block[row]:
                    of_block[row] += (name,)
                found += 1
        if found == 0:
            self.without.append(name)


# More elements that all have numbers of their own are numbered, not grouped.
NUMBERED = 20


def add_labels(np, groups, name, arrays, names, notes):
    """Whole numbers of elements, such as property or material numbers, are groups."""
    arrays = [np.asarray(array) for array in arrays]
    if any(a.ndim != 1 or a.dtype.kind not in "iu" for a in arrays):
        return
    labels = sorted(set().union(*(set(a.tolist()) for a in arrays)))
    if len(labels) > 1000:
        notes.append(f"the numbers {name} of the elements have {len(labels)} values, and make no groups")
        return
    if NUMBERED < len(labels) == sum(len(array) for array in arrays):
        notes.append(f"the numbers {name} of the elements are all different, and make no groups")
        return
    dimension = {"tetra10": 3, "triangle6": 2}
    prefix = name.split(":")[-1]
    for label in labels:
        for number, array in enumerate(arrays):
            kind, rows = groups.kind.get(number), np.flatnonzero(array == label)
            if kind is None or len(rows) == 0 or (names is not None and label == 0):
                continue
            known = (names or {}).get((label, dimension[kind])) or (names or {}).get(label)
            only = [[] for _ in arrays]
            only[number] = rows
            for group in known or [f"{prefix}_{label}"]:
                groups.add(np, group, only)


def plain(name):
    """A name that MSH can hold."""
    return " ".join(name.replace('"', "'").split())


def write(np, target, points, blocks, groups, point_sets):
    """MSH 4.1 in text: an entity for each combination of groups."""
    physical = {2: {}, 3: {}, 0: {}}
    entities = {0: [], 2: [], 3: []}  # tags of physical groups, element type, rows of nodes

    def tag(dimension, name):
        return physical[dimension].setdefault(name, len(physical[dimension]) + 1)

    for kind, nodes, number in blocks:
        dimension, element_type = (3, 11) if kind == "tetra10" else (2, 9)
        combinations = {}
        for row, names in enumerate(groups.of_block[number]):
            combinations.setdefault(names, []).append(row)
        for names, rows in combinations.items():
            if names or dimension == 3:
                entities[dimension].append(([tag(dimension, name) for name in names], element_type, nodes[rows]))
    for name, nodes in point_sets.items():
        entities[0].append(([tag(0, name)], 15, np.asarray(nodes, dtype=int).reshape(-1, 1)))

    used = np.unique(np.concatenate([nodes.reshape(-1) for kind, nodes, _ in blocks if kind == "tetra10"]))
    numbering = np.zeros(len(points), dtype=int)
    numbering[used] = np.arange(1, len(used) + 1)
    low, high = points[used].min(axis=0), points[used].max(axis=0)
    box = " ".join(repr(float(x)) for x in [*low, *high])
    with open(target, "w", encoding="utf-8") as out:
        out.write("$MeshFormat\n4.1 0 8\n$EndMeshFormat\n")
        names = [(d, t, name) for d in (0, 2, 3) for name, t in physical[d].items()]
        out.write(f"$PhysicalNames\n{len(names)}\n")
        for dimension, number, name in names:
            out.write(f'{dimension} {number} "{plain(name)}"\n')
        out.write("$EndPhysicalNames\n$Entities\n")
        out.write(f"{len(entities[0])} 0 {len(entities[2])} {len(entities[3])}\n")
        for dimension in (0, 2, 3):
            for number, (tags, _, _) in enumerate(entities[dimension], start=1):
                where = " ".join(repr(float(x)) for x in low) if dimension == 0 else box
                words = [str(number), where, str(len(tags)), *map(str, tags)]
                out.write(" ".join(words) + (" 0" if dimension else "") + "\n")
        out.write(f"$EndEntities\n$Nodes\n1 {len(used)} 1 {len(used)}\n3 1 0 {len(used)}\n")
        out.write("\n".join(map(str, range(1, len(used) + 1))) + "\n")
        out.write("\n".join(" ".join(map(repr, row)) for row in points[used].tolist()) + "\n$EndNodes\n")
        # Nodes that no tetrahedron has are left out, and what is made of them.
        kept = {d: [(t, numbering[rows][(numbering[rows] > 0).all(axis=1)]) for _, t, rows in entities[d]] for d in entities}
        count = sum(len(rows) for d in kept for _, rows in kept[d])
        blocks_written = sum(1 for d in kept for _, rows in kept[d] if len(rows))
        out.write(f"$Elements\n{blocks_written} {count} 1 {count}\n")
        element = 0
        for dimension in (0, 2, 3):
            for number, (element_type, rows) in enumerate(kept[dimension], start=1):
                if len(rows) == 0:
                    continue
                out.write(f"{dimension} {number} {element_type} {len(rows)}\n")
                for row in rows.tolist():
                    element += 1
                    out.write(f"{element} {' '.join(map(str, row))}\n")
        out.write("$EndElements\n")


try:
    print(json.dumps(main(sys.argv[1], sys.argv[2], "raise" in sys.argv[3:])))
except Refused as refused:
    print(json.dumps({"error": str(refused), "help": refused.help}))
except MemoryError:
    raise
except Exception as error:
    print(json.dumps({"error": f"its parts do not make a mesh: {in_words(error)}", "help": "check the file, or write it as VTU, .inp or MSH 4.1"}))
