// A square bar of slenderness 70: 10 x 10 mm, 202.07 mm long, its root at x = 0 and its line along x.
SetFactory("OpenCASCADE");
Box(1) = {0, -5, -5, 202.07, 10, 10};
Physical Volume("bar") = {1};
Physical Surface("root") = {1};
Mesh.MeshSizeMin = 10;
Mesh.MeshSizeMax = 10;
Mesh.ElementOrder = 2;
