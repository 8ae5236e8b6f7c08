// A quarter of a disc, curved, with a group that has a number and no name.
//   gmsh -3 quarter.geo -o quarter.msh
// The same mesh with much that a reader has to pass over (surface elements, periodic faces, parametric nodes, partitions):
//   gmsh -3 quarter.geo -setnumber Mesh.SaveAll 1 -setnumber Mesh.SaveParametric 1 -o quarter_everything.msh
//   gmsh -3 quarter.geo -setnumber Mesh.SaveAll 1 -setnumber Mesh.SaveParametric 1 -bin -o quarter_everything_binary.msh
//   gmsh -3 quarter.geo -part 2 -o quarter_partitioned.msh
SetFactory("OpenCASCADE");
Cylinder(1) = {0, 0, 0, 0, 0, 4, 20, Pi/2};
Periodic Surface {2} = {3} Translate {0, 0, 4};
Physical Volume(7) = {1};
Mesh.MeshSizeMin = 9;
Mesh.MeshSizeMax = 9;
Mesh.ElementOrder = 2;
