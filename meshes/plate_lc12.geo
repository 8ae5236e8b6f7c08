// The plate of the paper: 1000 x 50 x 10 mm, uniform size 12: the mesh of the table of errors in crates/dynamics/tests/conservative.
SetFactory("OpenCASCADE");
Box(1) = {-500, -25, 0, 1000, 50, 10};
Physical Volume("plate") = {1};
Mesh.MeshSizeMin = 12;
Mesh.MeshSizeMax = 12;
Mesh.ElementOrder = 2;
