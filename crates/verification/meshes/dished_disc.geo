// A dished disc: hub radius 30 mm, outer radius 240 mm, 15 mm thick, its middle surface a cone that rises by 60 mm. Elements have straight
// sides, so that other programs integrate them as well. "hub" is the inner face.
a = 0.03; b = 0.24; t = 0.015; rise = 0.06; around = 5; along = 5;
Point(1) = {a, 0, -t/2}; Point(2) = {b, 0, rise - t/2}; Point(3) = {b, 0, rise + t/2}; Point(4) = {a, 0, t/2};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 1};
Curve Loop(1) = {1, 2, 3, 4}; Plane Surface(1) = {1};
Transfinite Curve{1, 3} = along + 1; Transfinite Curve{2, 4} = 2; Transfinite Surface{1};
first[] = Extrude {{0, 0, 1}, {0, 0, 0}, Pi/2} { Surface{1}; Layers{around}; };
second[] = Extrude {{0, 0, 1}, {0, 0, 0}, Pi/2} { Surface{first[0]}; Layers{around}; };
third[] = Extrude {{0, 0, 1}, {0, 0, 0}, Pi/2} { Surface{second[0]}; Layers{around}; };
fourth[] = Extrude {{0, 0, 1}, {0, 0, 0}, Pi/2} { Surface{third[0]}; Layers{around}; };
Coherence;
Physical Volume("disc") = {first[1], second[1], third[1], fourth[1]};
Physical Surface("hub") = {first[5], second[5], third[5], fourth[5]};
Mesh.ElementOrder = 2;
Mesh.SecondOrderLinear = 1;
