"""Reads a reduced body in the forms of other programs, and prints what it finds as JSON.

usage: read_hand_over.py FILE

OP4 and OP2 are read by pyYeti and by pyNastran, which have to agree; glTF by pygltflib. The other forms are read here as the programs read them that
they are for: `modal.cc` of MBDyn, `InitFlexModes` of 42, the keywords of Standard Input Data.
"""

import json
import re
import struct
import sys


def op4(path):
    import numpy as np
    from pyNastran.op4.op4 import read_op4
    from pyyeti.nastran import op4 as yeti

    ours = yeti.load(path, into="dct")
    ours = {name.upper(): np.asarray(value[0] if isinstance(value, tuple) else value) for name, value in ours.items()}
    theirs = read_op4(path, debug=False)
    found = {}
    for name, matrix in theirs.items():
        data = getattr(matrix, "data", matrix)
        data = np.asarray(data[1] if isinstance(data, tuple) else data)
        assert np.array_equal(data, ours[name.upper()]), name
        found[name.upper()] = data.tolist()
    return found


def op2(path):
    import numpy as np
    from pyNastran.op2.op2 import OP2
    from pyyeti.nastran import op2 as yeti

    with yeti.OP2(path) as file:
        ours = file.rdop2mats()
    model = OP2(debug=None)
    model.set_additional_matrices_to_read({"TREC": True})
    model.read_op2(path)
    assert set(ours) == set(model.matrices), (set(ours), set(model.matrices))
    found = {}
    for name, matrix in model.matrices.items():
        data = matrix.data
        data = data.toarray() if hasattr(data, "toarray") else np.asarray(data)
        assert np.array_equal(data, ours[name]), name
        found[name] = data.tolist()
    return found


def mbdyn(path):
    groups, lines = {}, []
    for line in open(path):
        group = re.match(r"\*\* RECORD GROUP (\d+),", line)
        if group:
            lines = groups.setdefault(group[1], [])
        elif not line.startswith("**"):
            lines.append(line.split())
    head = groups["1"][0]
    nodes, modes = int(head[1]), int(head[2])
    number = {key: [[float(x) for x in line] for line in groups[key]] for key in groups if int(key) > 4}
    assert len(groups["2"]) == nodes and len(number["8"]) == nodes * modes
    assert all(len(line) == 6 for line in number["8"])
    return {"nodes": groups["2"], "groups": number}


def flex42(path):
    lines = [line.split("!")[0].split() for line in open(path)]
    at = 2

    def take():
        nonlocal at
        at += 1
        return lines[at - 1]

    def sparse():
        take()
        return [[float(x) for x in take()] for _ in range(int(take()[0]))]

    count = int(take()[0])
    take()
    for _ in range(count):
        assert len(take()) == 2
    take()
    joints = [sparse(), sparse()]
    take()
    shapes, turns = sparse(), sparse()
    mass, stiffness, damping = sparse(), sparse(), sparse()
    take()
    linear = [[float(x) for x in take()] for _ in range(count)]
    take()
    angular = [[float(x) for x in take()] for _ in range(count)]
    first, second = sparse(), sparse()
    assert take() == ["[EOF]"] and joints == [[], []]
    return {
        "modes": count, "psi": shapes, "theta": turns, "mass": mass, "stiffness": stiffness, "damping": damping,
        "pf": linear, "hf": angular, "l": first, "n": second,
    }


def sid(path):
    lines = [line.strip() for line in open(path)]
    tree, stack, node = {}, [], None
    for line in lines[1:]:
        match = re.match(r"m([01])\(([\d, ]+)\)\s*=\s*(\S+)", line)
        if match:
            entry = [int(x) for x in match[2].split(",")] + [float(match[3].replace("D", "e"))]
            tree.setdefault("/".join(stack), {}).setdefault("m" + match[1], []).append(entry)
        elif line.startswith("end "):
            assert stack.pop().split(":")[0] == line[4:], line
        elif line.startswith("new node"):
            stack.append("node:" + line.split("=")[1].strip())
        elif line == "new modal":
            stack.append("modal")
        elif "=" in line:
            key, value = (part.strip() for part in line.split("=", 1))
            tree.setdefault("/".join(stack), {})[key] = value
        else:
            stack.append(line)
    assert stack == []
    return tree


def glb(path):
    from pygltflib import GLTF2

    document = GLTF2().load(path)
    blob = document.binary_blob()

    def read(number):
        accessor = document.accessors[number]
        view = document.bufferViews[accessor.bufferView]
        size = {"SCALAR": 1, "VEC3": 3}[accessor.type] * accessor.count
        return struct.unpack_from(f"<{size}{'f' if accessor.componentType == 5126 else 'I'}", blob, view.byteOffset)

    primitive = document.meshes[0].primitives[0]
    positions = read(primitive.attributes.POSITION)
    return {
        "points": len(positions) // 3,
        "triangles": len(read(primitive.indices)) // 3,
        "last_index": max(read(primitive.indices)),
        "extent": [max(positions[i::3]) - min(positions[i::3]) for i in range(3)],
        "largest": [max(map(abs, read(target["POSITION"]))) for target in primitive.targets],
        "animations": [animation.name for animation in document.animations],
        "weights": [len(read(animation.samplers[0].output)) for animation in document.animations],
    }


READERS = {"op2": op2, "op4": op4, "fem": mbdyn, "flex42": flex42, "sid_fem": sid, "glb": glb}

if __name__ == "__main__":
    json.dump(READERS[sys.argv[1].rsplit(".", 1)[1]](sys.argv[1]), sys.stdout)
