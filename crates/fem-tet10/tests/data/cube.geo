// A cube, right and in the ways that are refused:
//   gmsh -3 -order 2 cube.geo -o cube.msh
//   gmsh -3 -order 2 cube.geo -bin -o cube_binary.msh
//   gmsh -3 -order 2 cube.geo -setnumber groups 1 -o cube_groups.msh
//   gmsh -3 -order 2 cube.geo -setnumber groups 1 -bin -o cube_groups_binary.msh
//   gmsh -3 -order 1 cube.geo -o cube_order_1.msh
//   gmsh -3 -order 3 cube.geo -o cube_order_3.msh
//   gmsh -3 -order 2 cube.geo -format msh22 -o cube_msh22.msh
//   gmsh -3 -order 2 cube.geo -setnumber hexahedra 1 -o cube_hexahedra.msh
//   gmsh -3 -order 3 cube.geo -setnumber hexahedra 1 -o cube_hexahedra_order_3.msh
DefineConstant[ hexahedra = 0, groups = 0 ];
SetFactory("OpenCASCADE");
Box(1) = {0, 0, 0, 10, 10, 10};
Physical Volume("cube") = {1};
If (groups)
  Physical Surface("foot") = {5};
  Physical Curve("edge") = {1};
  Physical Point("corner") = {1};
EndIf
Mesh.MeshSizeMin = 10;
Mesh.MeshSizeMax = 10;
If (hexahedra)
  Transfinite Curve {:} = 2;
  Transfinite Surface {:};
  Recombine Surface {:};
  Transfinite Volume {:};
EndIf
