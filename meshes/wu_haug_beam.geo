// The beam of Kane, Ryan and Banerjee (1987), and of Wu and Haug (1988): length 8 along x from the hinge; a square section
// that bends in the plane of the rotation as theirs does.
SetFactory("OpenCASCADE");
side = 0.036765;
Box(1) = {0, -side/2, -side/2, 8, side, side};
Physical Volume("beam") = {1};
Transfinite Curve {1, 2, 3, 4, 5, 6, 7, 8} = 2;
Transfinite Curve {9, 10, 11, 12} = 61;
Transfinite Surface "*";
Transfinite Volume "*";
Mesh.ElementOrder = 2;
