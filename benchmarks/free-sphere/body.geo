// A ball of radius 10 mm.
SetFactory("OpenCASCADE");
Sphere(1) = {0, 0, 0, 0.01};
Physical Volume("ball") = {1};
Mesh.MeshSizeMin = 0.003;
Mesh.MeshSizeMax = 0.003;
Mesh.ElementOrder = 2;
