// A cylinder of radius 0.1524 m and length 0.6096 m.
SetFactory("OpenCASCADE");
Cylinder(1) = {0, 0, 0, 0, 0, 0.6096, 0.1524};
Physical Volume("cylinder") = {1};
Mesh.MeshSizeMin = 0.06;
Mesh.MeshSizeMax = 0.06;
Mesh.ElementOrder = 2;
