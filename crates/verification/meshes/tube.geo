// A closed tube of 1 x 0.1 x 0.1 along x, its walls 0.01 thick and its ends 0.02; SI.
SetFactory("OpenCASCADE");
Box(1) = {0, -0.05, -0.05, 1, 0.1, 0.1};
Box(2) = {0.02, -0.04, -0.04, 0.96, 0.08, 0.08};
BooleanDifference(3) = { Volume{1}; Delete; }{ Volume{2}; Delete; };
Physical Volume("tube") = {3};
Physical Surface("inside") = Surface In BoundingBox {0.01, -0.045, -0.045, 0.99, 0.045, 0.045};
Physical Surface("end") = Surface In BoundingBox {-0.001, -0.051, -0.051, 0.001, 0.051, 0.051};
Mesh.MeshSizeMin = 0.07; Mesh.MeshSizeMax = 0.07;
Mesh.ElementOrder = 2;
