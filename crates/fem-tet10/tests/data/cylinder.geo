// A cylinder with physical groups of every dimension:
//   gmsh -3 cylinder.geo -o cylinder.msh
//   gmsh -3 cylinder.geo -bin -o cylinder_binary.msh
//   gmsh -3 cylinder.geo -setnumber size 2 -o cylinder_fine.msh
DefineConstant[ size = 4 ];
SetFactory("OpenCASCADE");
Cylinder(1) = {3, 4, 5, 0, 0, 8, 4};
Physical Volume("body") = {1};
Physical Surface("side") = {1};
Physical Surface("head") = {2};
Physical Surface("foot") = {3};
Physical Surface("all round") = {1, 2, 3};
Physical Surface(9) = {2};
Physical Curve("rim") = {1};
Physical Point("mark") = {1};
Mesh.MeshSizeMin = size;
Mesh.MeshSizeMax = size;
Mesh.ElementOrder = 2;
