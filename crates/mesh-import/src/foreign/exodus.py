"""Reads the mesh of an Exodus file: nodes, blocks, side sets and node sets with their names. NetCDF is of two kinds: HDF5, and
the classic one, whose few parts are read here."""

import struct

# Corners of the sides of a tetrahedron, and the nodes between them.
SIDES = [(0, 1, 3, 4, 8, 7), (1, 2, 3, 5, 9, 8), (0, 3, 2, 7, 9, 6), (0, 2, 1, 6, 5, 4)]
# Kinds of elements by the first letters of their names, and the numbers of their nodes.
TETRAHEDRA = {4: "tetra", 10: "tetra10"}
TRIANGLES = {3: "triangle", 6: "triangle6"}
# Types of numbers in classic NetCDF.
TYPES = {1: "i1", 2: "S1", 3: ">i2", 4: ">i4", 5: ">f4", 6: ">f8", 7: "u1", 8: ">u2", 9: ">u4", 10: ">i8", 11: ">u8"}


class Variables:
    """Arrays of a file by name, with their attributes in text."""

    def __init__(self, np, path):
        self.np = np
        self.attributes = {}
        with open(path, "rb") as file:
            head = file.read(4)
        if head[:3] == b"CDF":
            self.arrays = self.classic(open(path, "rb").read())
        else:
            import h5py

            with h5py.File(path, "r") as file:
                sets = {name: data for name, data in file.items() if isinstance(data, h5py.Dataset) and data.shape}
                # Results are larger than the mesh.
                self.arrays = {name: data[()] for name, data in sets.items() if "vals_" not in name}
                for name, data in sets.items():
                    kind = data.attrs.get("elem_type")
                    self.attributes[name] = kind.decode() if isinstance(kind, bytes) else str(kind or "")

    def classic(self, data):
        np, at, version = self.np, 4, data[3]
        count_format, offset_format = (">q" if version == 5 else ">i"), (">i" if version == 1 else ">q")

        def number(form):
            nonlocal at
            (found,) = struct.unpack_from(form, data, at)
            at += struct.calcsize(form)
            return found

        def padded(size):
            nonlocal at
            found = data[at : at + size]
            at += -(-size // 4) * 4
            return found

        def entries():
            number(">i")
            return range(number(count_format))

        def name():
            return padded(number(count_format)).decode("utf-8", "replace")

        def attributes():
            found = {}
            for _ in entries():
                key, kind, count = name(), number(">i"), number(count_format)
                value = padded(count * np.dtype(TYPES[kind]).itemsize)
                found[key] = value.decode("utf-8", "replace") if kind == 2 else value
            return found

        number(count_format)
        sizes = [(name(), number(count_format))[1] for _ in entries()]
        attributes()
        arrays = {}
        for _ in entries():
            key = name()
            shape = [sizes[number(count_format)] for _ in range(number(count_format))]
            self.attributes[key] = attributes().get("elem_type", "")
            kind, _, begin = TYPES[number(">i")], number(count_format), number(offset_format)
            # A dimension without a size is that of time.
            if shape and all(shape):
                count = int(np.prod(shape))
                arrays[key] = np.frombuffer(data, kind, count, begin).reshape(shape)
        return arrays

    def names(self, key, ids, count, word):
        """Names of blocks or sets: those that are written, or the word with their number."""
        written = self.arrays.get(key)
        numbers = self.arrays.get(ids, range(1, count + 1))
        found = []
        for row, number in zip(range(count), numbers):
            name = b""
            if written is not None:
                name = bytes(written[row].tobytes()).split(b"\0")[0].strip()
            found.append(name.decode("utf-8", "replace") or f"{word}_{int(number)}")
        return found

    def numbered(self, pattern):
        """Arrays whose names end in a number from 1."""
        found, number = [], 1
        while any(key.startswith(pattern) and key == f"{pattern}{number}" for key in self.arrays):
            found.append(self.arrays[f"{pattern}{number}"])
            number += 1
        return found


def exodus(np, path, file_of, refused, notes):
    """The parts of a file that are read; `file_of` makes them of points and blocks."""
    variables = Variables(np, path)
    arrays = variables.arrays
    if "coord" in arrays:
        points = arrays["coord"].T
    elif "coordx" in arrays:
        # A flat mesh has no z.
        x = arrays["coordx"]
        points = np.stack([x, arrays.get("coordy", 0 * x), arrays.get("coordz", 0 * x)], axis=1)
    else:
        raise refused("it has no nodes", "check the file, and write its mesh anew")
    blocks = []
    of_element = []  # for each element of the file, its block and row
    connects = {key: array for key, array in arrays.items() if key.startswith("connect") and key[7:].isdigit()}
    for key in sorted(connects, key=lambda key: int(key[7:])):
        nodes = connects[key].astype(int) - 1
        kind = variables.attributes.get(key, "").strip("\0 ").lower()
        known = TETRAHEDRA if kind.startswith("tet") else TRIANGLES if kind.startswith("tri") else {}
        if kind.startswith("hex"):
            kind = "hexahedron"
        of_element += [(len(blocks), row) for row in range(len(nodes))]
        blocks.append((known.get(nodes.shape[1], kind or "element"), nodes))
    count = len(blocks)
    names = variables.names("eb_names", "eb_prop1", count, "block")
    element_sets = {}
    for number, name in enumerate(names):
        element_sets.setdefault(name, {})[number] = np.arange(len(blocks[number][1]))
    elements = variables.numbered("elem_ss")
    sides = variables.numbered("side_ss")
    for name, of_set, side in zip(variables.names("ss_names", "ss_prop1", len(elements), "sideset"), elements, sides):
        faces, others = {}, 0
        for element, face in zip(of_set.tolist(), side.tolist()):
            block, row = of_element[element - 1]
            kind, nodes = blocks[block]
            if kind in TETRAHEDRA.values():
                corners = SIDES[face - 1] if kind == "tetra10" else SIDES[face - 1][:3]
                faces.setdefault(len(corners), []).append(nodes[row][list(corners)])
            elif kind in TRIANGLES.values():
                element_sets.setdefault(name, {}).setdefault(block, []).append(row)
            else:
                others += 1
        for size, rows in faces.items():
            element_sets.setdefault(name, {})[len(blocks)] = np.arange(len(rows))
            blocks.append((TRIANGLES[size], np.array(rows)))
        if others:
            notes.append(f"the side set {name} has {others} sides of elements that are no tetrahedra and no triangles")
    file = file_of(np, points, blocks)
    for name, rows in element_sets.items():
        file.element_sets[name] = [rows.get(number, []) for number in range(len(blocks))]
    nodes = variables.numbered("node_ns")
    for name, of_set in zip(variables.names("ns_names", "ns_prop1", len(nodes), "nodeset"), nodes):
        file.node_sets[name] = of_set.astype(int) - 1
    return file
