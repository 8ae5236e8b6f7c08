// A blade swept by 30 degrees: an arc of radius 2 from its root at x = 0 in the plane z = 0, its section 0.02 in the plane and
// 0.03 across; SI.
Point(1) = {0, -0.01, -0.015};
line[] = Extrude {0, 0.02, 0} { Point{1}; Layers{1}; };
face[] = Extrude {0, 0, 0.03} { Line{line[1]}; Layers{1}; };
body[] = Extrude {{0, 0, 1}, {0, 2, 0}, Pi/6} { Surface{face[1]}; Layers{32}; };
Physical Volume("blade") = {body[1]};
Physical Surface("root") = {face[1]};
Physical Surface("tip") = {body[0]};
Mesh.ElementOrder = 2;
Mesh.SecondOrderLinear = 1;
