// A hub of 1 m with a panel of 3 m on either side.
SetFactory("OpenCASCADE");
Box(1) = {-0.5, -0.5, -0.5, 1, 1, 1};
Box(2) = {0.5, -0.5, -0.02, 3, 1, 0.04};
Box(3) = {-3.5, -0.5, -0.02, 3, 1, 0.04};
BooleanUnion{ Volume{1}; Delete; }{ Volume{2, 3}; Delete; }
Mesh.MeshSizeMax = 0.5;
Physical Volume("all") = {1};
