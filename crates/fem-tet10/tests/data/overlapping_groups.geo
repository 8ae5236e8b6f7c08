// A block and its tip, sharing its nodes, in groups that overlap: the whole, the tip, and one without a name.
//   gmsh -3 overlapping_groups.geo -o overlapping_groups.msh
//   gmsh -3 overlapping_groups.geo -bin -o overlapping_groups_binary.msh
//   gmsh -3 overlapping_groups.geo -part 2 -o overlapping_groups_partitioned.msh
//   gmsh -3 overlapping_groups.geo -part 2 -part_ghosts -bin -o overlapping_groups_partitioned_binary.msh
SetFactory("OpenCASCADE");
Box(1) = {0, 0, 0, 20, 10, 10};
Box(2) = {20, 0, 0, 8, 10, 10};
BooleanFragments{ Volume{1}; Delete; }{ Volume{2}; Delete; }
Physical Volume("all") = {1, 2};
Physical Volume("tip") = {2};
Physical Volume(7) = {1};
Mesh.MeshSizeMin = 20;
Mesh.MeshSizeMax = 20;
Mesh.ElementOrder = 2;
