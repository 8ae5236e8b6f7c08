// A bulky block, 100 x 80 x 60 mm; cases.py replaces the size.
SetFactory("OpenCASCADE");
Box(1) = {-50, -40, -30, 100, 80, 60};
Physical Volume("block") = {1};
Mesh.MeshSizeMin = 8;
Mesh.MeshSizeMax = 8;
Mesh.ElementOrder = 2;
