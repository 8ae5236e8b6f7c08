// A connecting rod of aluminium, 120 mm from eye to eye: a shaft of 12 x 6 mm between a big and a small end. Units: mm.
SetFactory("OpenCASCADE");
length = 120;
Cylinder(1) = {0, 0, -4, 0, 0, 8, 16};
Cylinder(2) = {length, 0, -4, 0, 0, 8, 12};
Box(3) = {0, -6, -3, length, 12, 6};
BooleanUnion(4) = { Volume{1}; Delete; }{ Volume{2, 3}; Delete; };
Cylinder(5) = {0, 0, -4, 0, 0, 8, 10};
Cylinder(6) = {length, 0, -4, 0, 0, 8, 7};
BooleanDifference(7) = { Volume{4}; Delete; }{ Volume{5, 6}; Delete; };
Physical Volume("rod") = {7};
// The bores, found by the boxes that they are in.
Physical Surface("crank pin") = Surface In BoundingBox {-10.1, -10.1, -4.1, 10.1, 10.1, 4.1};
Physical Surface("piston pin") = Surface In BoundingBox {length - 7.1, -7.1, -4.1, length + 7.1, 7.1, 4.1};
