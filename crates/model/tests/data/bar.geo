// A bar of 200 x 10 x 10 mm along x, from x = 0, about the x-axis.
lc = 10;
Point(1) = {0, -5, -5}; Point(2) = {0, 5, -5}; Point(3) = {0, 5, 5}; Point(4) = {0, -5, 5};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 1};
Curve Loop(1) = {1, 2, 3, 4}; Plane Surface(1) = {1};
Transfinite Curve {1, 2, 3, 4} = 3; Transfinite Surface {1};
out[] = Extrude {200, 0, 0} { Surface{1}; Layers{32}; };
Physical Volume("bar") = {out[1]};
Physical Surface("root") = {1};
Physical Surface("tip") = {out[0]};
Physical Surface("top") = {out[4]};
Physical Surface("sides") = {out[2], out[3], out[5]};
