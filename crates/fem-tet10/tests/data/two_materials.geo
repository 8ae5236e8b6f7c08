// A block with a tip of another material, sharing its nodes: two groups by name, and a plane surface group.
//   gmsh -3 two_materials.geo -o two_materials.msh
//   gmsh -3 two_materials.geo -bin -o two_materials_binary.msh
SetFactory("OpenCASCADE");
Box(1) = {0, 0, 0, 20, 10, 10};
Box(2) = {20, 0, 0, 8, 10, 10};
BooleanFragments{ Volume{1}; Delete; }{ Volume{2}; Delete; }
Physical Volume("block") = {1};
Physical Volume("tip") = {2};
Physical Surface("foot") = {1};
Mesh.MeshSizeMin = 8;
Mesh.MeshSizeMax = 8;
Mesh.ElementOrder = 2;
