// A disc of radius 100 mm and thickness 4 mm about z.
SetFactory("OpenCASCADE");
Cylinder(1) = {0, 0, -2, 0, 0, 4, 100};
Physical Volume("disc") = {1};
Mesh.MeshSizeMin = 12;
Mesh.MeshSizeMax = 12;
Mesh.ElementOrder = 2;
