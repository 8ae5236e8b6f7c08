// A tapered plate, 10 m long, 5 m wide at the root and 1 m at the tip, 0.05 m thick, in 16 x 8 x 1 bricks that are cut into tetrahedra.
Point(1) = {0, -2.5, -0.025};
Point(2) = {10, -0.5, -0.025};
Point(3) = {10, 0.5, -0.025};
Point(4) = {0, 2.5, -0.025};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 1};
Curve Loop(1) = {1, 2, 3, 4};
Plane Surface(1) = {1};
Transfinite Curve {1, 3} = 17;
Transfinite Curve {2, 4} = 9;
Transfinite Surface {1};
body[] = Extrude {0, 0, 0.05} { Surface{1}; Layers{1}; };
Physical Volume("plate") = {body[1]};
Physical Surface("root") = {body[5]};
Mesh.ElementOrder = 2;
