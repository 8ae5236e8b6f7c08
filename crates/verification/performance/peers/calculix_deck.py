"""Writes a scene's free body as an input file of CalculiX: ten-node tetrahedra, point masses, natural frequencies.

Usage: calculix_deck.py SCENE MODES FILE.inp
"""

import sys

from matrices import Body

scene, modes, file = sys.argv[1:]
body = Body(scene)
with open(file, "w") as deck:
    deck.write("*NODE, NSET=ALL\n")
    # A field of CalculiX has at most twenty characters.
    deck.writelines(f"{i},{x:.12e},{y:.12e},{z:.12e}\n" for i, (x, y, z) in enumerate(body.points, 1))
    deck.write("*ELEMENT, TYPE=C3D10, ELSET=SOLID\n")
    deck.writelines(f"{i},{','.join(map(str, nodes))}\n" for i, nodes in enumerate((body.tets + 1).tolist(), 1))
    for i, (node, mass) in enumerate(body.point_masses, 1):
        deck.write(
            f"*ELEMENT, TYPE=MASS, ELSET=MASS{i}\n{len(body.tets) + i},{node + 1}\n*MASS, ELSET=MASS{i}\n{mass}\n"
        )
    material = body.material
    deck.write(f"*MATERIAL, NAME=MATERIAL\n*ELASTIC\n{material['young_modulus']},{material['poisson_ratio']}\n")
    deck.write(f"*DENSITY\n{material['density']}\n*SOLID SECTION, ELSET=SOLID, MATERIAL=MATERIAL\n")
    deck.write(f"*STEP\n*FREQUENCY\n{6 + int(modes)}\n*END STEP\n")
