// The beam of Simo and Vu-Quoc (1988) as a solid: length 10 along x from the hinge, square section of the same EA, EI.
SetFactory("OpenCASCADE");
side = 0.0774597;
Box(1) = {0, -side/2, -side/2, 10, side, side};
Physical Volume("beam") = {1};
Transfinite Curve {1, 2, 3, 4, 5, 6, 7, 8} = 2;
Transfinite Curve {9, 10, 11, 12} = 51;
Transfinite Surface "*";
Transfinite Volume "*";
Mesh.ElementOrder = 2;
