// The plate of the paper, 1000 x 50 x 10 mm, with elements of 60 mm.
SetFactory("OpenCASCADE");
Box(1) = {-500, -25, 0, 1000, 50, 10};
Physical Volume("plate") = {1};
Mesh.MeshSizeMin = 60;
Mesh.MeshSizeMax = 60;
Mesh.ElementOrder = 2;
