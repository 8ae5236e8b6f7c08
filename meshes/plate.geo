// The plate of the paper: 1000 x 50 x 10 mm, uniform size 10 (just below 10 gmsh splits the 10 mm edges).
SetFactory("OpenCASCADE");
Box(1) = {-500, -25, 0, 1000, 50, 10};
Physical Volume("plate") = {1};
Mesh.MeshSizeMin = 10;
Mesh.MeshSizeMax = 10;
Mesh.ElementOrder = 2;
