"""Reads a mesh with meshio (or meshlane) and writes its second-order tetrahedra with all named sets as MSH 4.1.

Arguments: the mesh file, the MSH file to write, and "raise" if first-order tetrahedra are to get mid-edge nodes.
Prints a line of JSON: what was left out ("notes"), or what is wrong ("error", with "cure").
"""

import json
import sys
from collections import Counter
from pathlib import Path

# The corners of each edge, and the edges in gmsh's order of the mid-edge nodes.
EDGES = {
    "tetra10": [(0, 1), (1, 2), (0, 2), (0, 3), (2, 3), (1, 3)],
    "triangle6": [(0, 1), (1, 2), (0, 2)],
}
RAISED = {"tetra": "tetra10", "triangle": "triangle6"}
CORNERS = {"tetra10": 4, "triangle6": 3}
# Abaqus' faces of a tetrahedron.
FACES = {"S1": (0, 1, 2), "S2": (0, 3, 1), "S3": (1, 3, 2), "S4": (2, 3, 0)}
CURE = "install it (pip install meshio h5py), or name a Python that has it in FLEXFRAME_PYTHON"


class Refused(Exception):
    def __init__(self, error, cure):
        super().__init__(error)
        self.cure = cure


def main(source, target, raise_order):
    try:
        import numpy as np
    except ImportError:
        raise Refused(f"{sys.executable} has no numpy", CURE)
    try:
        import meshio
    except ImportError:
        try:
            import meshlane as meshio
        except ImportError:
            raise Refused(f"{sys.executable} has neither meshio nor meshlane", CURE)

    try:
        mesh = meshio.read(prepared(meshio, source, Path(target)))
    except SystemExit as exit:  # meshio ends the program where it does not know a format
        raise Refused(f"meshio cannot read it: {exit}", "check its name and contents, or mesh again with gmsh")
    except Exception as error:
        words = f"{type(error).__name__}: {error}".strip(": ")
        raise Refused(f"meshio cannot read it: {words}", "check the file, or write it as VTU, .inp or MSH 4.1")

    points = np.asarray(mesh.points, dtype=float)
    if len(points) == 0:
        raise Refused("it has no nodes", "check the file")
    if points.ndim != 2 or points.shape[1] != 3:
        raise Refused(f"its nodes have {points.shape[-1]} coordinates", "write it in three dimensions")
    notes = []
    blocks = []  # kind, nodes, number of the block in the file
    others = Counter()
    for number, block in enumerate(mesh.cells):
        kind, nodes = block.type, np.asarray(block.data)
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
        raise Refused(f"it has elements that are no tetrahedra: {each}", "mesh with ten-node tetrahedra (C3D10, tetra10)")
    if not any(kind == "tetra10" for kind, _, _ in blocks):
        found = ", ".join(f"{count} {kind}" for kind, count in others.items()) or "no elements at all"
        raise Refused(f"it has no tetrahedra: {found}", "mesh the volume with ten-node tetrahedra")

    groups = Groups(blocks, notes)
    for name, rows in mesh.cell_sets.items():
        groups.add(np, name, rows, len(mesh.cells))
    for name, arrays in mesh.cell_data.items():
        add_labels(np, groups, mesh, name, arrays)
    surfaces, point_sets = {}, dict(mesh.point_sets)
    for number, names in getattr(mesh, "point_tags", {}).items():
        nodes = np.flatnonzero(np.asarray(mesh.point_data["point_tags"]) == number)
        for name in names:
            point_sets[name] = np.concatenate([point_sets.get(name, []), nodes]).astype(int)
    if Path(source).suffix.lower() == ".inp":
        surfaces = abaqus_surfaces(np, source, mesh, blocks, notes)
    for name, nodes in list(point_sets.items()):
        if len(nodes) == 0:
            notes.append(f"the node set {name} is empty")
            del point_sets[name]
    write(np, target, points, blocks, groups, surfaces, point_sets)
    return notes


# What solvers and gmsh call triangles of six nodes, and meshio does not know.
TRIANGLES = ["CPS6", "CPS6M", "CPE6M", "CAX6", "S6", "M3D6", "DS6", "SFM3D6", "R3D6"]
TETRAHEDRA = ["C3D10R", "C3D10HS", "C3D10MT", "C3D10T"]


def prepared(meshio, source, target):
    """What meshio can read of the file: it is strict about things that do not matter here."""
    ending = Path(source).suffix.lower()
    if ending == ".inp":
        types = meshio.abaqus._abaqus.abaqus_to_meshio_type
        types.update(dict.fromkeys(TRIANGLES, "triangle6") | dict.fromkeys(TETRAHEDRA, "tetra10"))
        types["C3D4H"] = "tetra"
    if ending in (".bdf", ".nas", ".fem"):
        text = Path(source).read_text(encoding="utf-8", errors="replace")
        if "BEGIN BULK" not in text.upper():
            # gmsh leaves the heads out.
            whole = target.with_suffix(ending)
            whole.write_text("BEGIN BULK\n" + text + "\nENDDATA\n", encoding="utf-8")
            return str(whole)
    return source


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
    wrong = np.flatnonzero((nearest != np.array(order)).any(axis=1))
    if len(wrong):
        element = ", ".join(str(node + 1) for node in nodes[wrong[0]])
        raise Refused(
            f"{len(wrong)} of its {len(nodes)} {kind} elements have nodes on edges in another order than the others, the first "
            f"is that of the nodes {element} (counted from 1)",
            "check the order of nodes, or mesh again with less curved elements",
        )
    return np.hstack([nodes[:, :corners], nodes[:, corners:][:, list(order)]])


class Groups:
    """For each element of each block, the names of the groups that it is in."""

    def __init__(self, blocks, notes):
        self.of_block = {number: [() for _ in nodes] for _, nodes, number in blocks}
        self.kind = {number: kind for kind, _, number in blocks}
        self.notes = notes

    def add(self, np, name, rows, count):
        if name.startswith("gmsh:bounding_entities"):
            return
        found = 0
        # meshio has an array for each block; of a set of sets it may have more.
        for at, rows_of_block in enumerate(rows):
            if rows_of_block is None:
                continue
            of_block = self.of_block.get(at % count)
            for row in np.asarray(rows_of_block, dtype=int).reshape(-1) if of_block is not None else []:
                if name not in of_block[row]:
                    of_block[row] += (name,)
                found += 1
        if found == 0:
            self.notes.append(f"the element set {name} has no tetrahedra and no triangles")


def add_labels(np, groups, mesh, name, arrays):
    """Whole numbers of elements, such as property or material numbers, are groups."""
    arrays = [np.asarray(array) for array in arrays]
    if name == "gmsh:geometrical" or any(a.ndim != 1 or a.dtype.kind not in "iu" for a in arrays):
        return
    # MED has names for the numbers of its families.
    families = getattr(mesh, "cell_tags", {}) if name == "cell_tags" else {}
    labels = sorted(set().union(*(set(a.tolist()) for a in arrays)))
    if len(labels) > 1000:
        return
    # gmsh's physical groups have names, by number and dimension.
    names = {(int(data[0]), int(data[1])): key for key, data in mesh.field_data.items() if len(data) == 2}
    dimension = {"tetra10": 3, "triangle6": 2}
    prefix = name.split(":")[-1]
    for label in labels:
        rows = [np.flatnonzero(array == label) for array in arrays]
        for number, of_block in enumerate(rows):
            kind = groups.kind.get(number)
            if kind is None or len(of_block) == 0 or (name in ("gmsh:physical", "cell_tags") and label == 0):
                continue
            known = names.get((label, dimension[kind])) if name == "gmsh:physical" else None
            only = [np.array([], dtype=int)] * len(rows)
            only[number] = of_block
            for group in families.get(label) or [known or f"{prefix}_{label}"]:
                groups.add(np, group, only, len(rows))


def abaqus_surfaces(np, source, mesh, blocks, notes):
    """Surfaces of element faces, which meshio leaves out: triangles of six nodes, by name."""
    kinds = {number: (kind, nodes) for kind, nodes, number in blocks}
    place, sets, surfaces = {}, {}, {}
    keyword, options, block = "", {}, -1
    expect = 0
    with open(source, encoding="utf-8", errors="replace") as lines:
        for line in lines:
            line = line.strip()
            if not line or line.startswith("**"):
                continue
            if line.startswith("*"):
                parts = [part.strip() for part in line[1:].split(",")]
                keyword = parts[0].upper()
                options = {k.strip().upper(): v.strip() for k, _, v in (part.partition("=") for part in parts[1:])}
                if keyword == "ELEMENT":
                    block, row, expect = block + 1, 0, 0
                    of_keyword = sets.setdefault(options["ELSET"].upper(), []) if "ELSET" in options else []
                elif keyword == "SURFACE" and options.get("TYPE", "ELEMENT").upper() == "ELEMENT":
                    surfaces[options.get("NAME", "")] = []
                elif keyword == "SURFACE":
                    notes.append(f"the surface {options.get('NAME', '')} is one of nodes, and is left out: name a node set")
                elif keyword == "INCLUDE":
                    notes.append("surfaces in included files are left out: put them into the file itself")
                continue
            numbers = [part.strip() for part in line.split(",") if part.strip()]
            if keyword == "ELEMENT":
                if expect <= 0:
                    place[int(numbers[0])] = (block, row)
                    of_keyword.append(int(numbers[0]))
                    row += 1
                    expect = mesh.cells[block].data.shape[1] + 1
                expect -= len(numbers)
            elif keyword == "ELSET":
                ids = sets.setdefault(options["ELSET"].upper(), [])
                if "GENERATE" in options:
                    first, last, step = (list(map(int, numbers)) + [1])[:3]
                    ids.extend(range(first, last + 1, step))
                else:
                    for number in numbers:
                        ids.extend([int(number)] if number.isdigit() else sets.get(number.upper(), []))
            elif keyword == "SURFACE" and options.get("TYPE", "ELEMENT").upper() == "ELEMENT":
                ids = [int(numbers[0])] if numbers[0].isdigit() else sets.get(numbers[0].upper(), [])
                surfaces[options.get("NAME", "")].extend((i, numbers[1].upper() if len(numbers) > 1 else "") for i in ids)
    found = {}
    edge_of = {frozenset(edge): column for column, edge in enumerate(EDGES["tetra10"], start=4)}
    for name, faces in surfaces.items():
        triangles = []
        for element, face in faces:
            kind, nodes = kinds.get(place.get(element, (-1, 0))[0], (None, None))
            if kind != "tetra10" or face not in FACES:
                continue
            of_element = nodes[place[element][1]]
            a, b, c = FACES[face]
            middles = [edge_of[frozenset(pair)] for pair in ((a, b), (b, c), (a, c))]
            triangles.append([of_element[k] for k in (a, b, c, *middles)])
        if len(triangles) < len(faces) or not faces:
            notes.append(f"of the surface {name}, {len(triangles)} of {len(faces)} faces are faces of tetrahedra")
        if triangles:
            found[name] = np.array(triangles)
    return found


def write(np, target, points, blocks, groups, surfaces, point_sets):
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
    for name, triangles in surfaces.items():
        entities[2].append(([tag(2, name)], 9, triangles))
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
            out.write(f'{dimension} {number} "{name}"\n')
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
    print(json.dumps({"notes": main(sys.argv[1], sys.argv[2], "raise" in sys.argv[3:])}))
except Refused as refused:
    print(json.dumps({"error": str(refused), "cure": refused.cure}))
