// A cube, right and in the ways that are refused:
//   gmsh -3 -order 2 cube.geo -o cube.msh
//   gmsh -3 -order 2 cube.geo -bin -o cube_binary.msh
//   gmsh -3 -order 1 cube.geo -o cube_order_1.msh
//   gmsh -3 -order 3 cube.geo -o cube_order_3.msh
//   gmsh -3 -order 2 cube.geo -format msh22 -o cube_msh22.msh
//   gmsh -3 -order 2 cube.geo -setnumber hexahedra 1 -o cube_hexahedra.msh
//   gmsh -3 -order 3 cube.geo -setnumber hexahedra 1 -o cube_hexahedra_order_3.msh
DefineConstant[ hexahedra = 0 ];
SetFactory("OpenCASCADE");
Box(1) = {0, 0, 0, 10, 10, 10};
Physical Volume("cube") = {1};
Mesh.MeshSizeMin = 10;
Mesh.MeshSizeMax = 10;
If (hexahedra)
  Transfinite Curve {:} = 2;
  Transfinite Surface {:};
  Recombine Surface {:};
  Transfinite Volume {:};
EndIf
