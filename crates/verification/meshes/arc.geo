// A quarter of a circle of radius 1 from its root at x = 0 in the plane y = 0, its section 0.02 in the plane and 0.03 across; SI.
Point(1) = {0, -0.015, -0.01};
line[] = Extrude {0, 0.03, 0} { Point{1}; Layers{1}; };
face[] = Extrude {0, 0, 0.02} { Line{line[1]}; Layers{1}; };
body[] = Extrude {{0, -1, 0}, {0, 0, 1}, Pi/2} { Surface{face[1]}; Layers{40}; };
Physical Volume("arc") = {body[1]};
Physical Surface("root") = {face[1]};
Physical Surface("tip") = {body[0]};
Mesh.ElementOrder = 2;
Mesh.SecondOrderLinear = 1;
