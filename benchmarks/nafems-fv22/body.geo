// A rhombic plate, side 10 m, skew 45°, 1 m thick, in 12 x 12 x 2 bricks that are cut into tetrahedra.
Point(1) = {0, 0, 0};
Point(2) = {10, 0, 0};
Point(3) = {17.071067811865476, 7.0710678118654755, 0};
Point(4) = {7.0710678118654755, 7.0710678118654755, 0};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 1};
Curve Loop(1) = {1, 2, 3, 4};
Plane Surface(1) = {1};
Transfinite Curve {1:4} = 13;
Transfinite Surface {1};
body[] = Extrude {0, 0, 1} { Surface{1}; Layers{2}; };
Physical Volume("plate") = {body[1]};
Physical Surface("edges") = {body[2], body[3], body[4], body[5]};
Mesh.ElementOrder = 2;
