// A shaft along x, 10 m long, 0.5 m thick.
SetFactory("OpenCASCADE");
Cylinder(1) = {0, 0, 0, 10, 0, 0, 0.25};
Physical Volume("shaft") = {1};
Physical Surface("tip") = {2};
Physical Surface("root") = {3};
Mesh.MeshSizeMin = 0.3;
Mesh.MeshSizeMax = 0.3;
Mesh.ElementOrder = 2;
