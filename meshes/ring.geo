// A thick ring, 200 mm across, with a square notch on one side: curved elements, no symmetry but one plane.
SetFactory("OpenCASCADE");
Cylinder(1) = {0, 0, 0, 0, 0, 20, 100};
Cylinder(2) = {0, 0, 0, 0, 0, 20, 80};
BooleanDifference(3) = { Volume{1}; Delete; }{ Volume{2}; Delete; };
Box(4) = {75, -10, 10, 30, 20, 20};
BooleanDifference(5) = { Volume{3}; Delete; }{ Volume{4}; Delete; };
Physical Volume("ring") = {5};
Mesh.MeshSizeMin = 12;
Mesh.MeshSizeMax = 12;
Mesh.ElementOrder = 2;
