// A slender column of 1 x 0.025 x 0.025 along x from its origin, about the x-axis, one element across; SI.
Point(1) = {0, -0.0125, -0.0125};
line[] = Extrude {0, 0.025, 0} { Point{1}; Layers{1}; };
face[] = Extrude {0, 0, 0.025} { Line{line[1]}; Layers{1}; };
body[] = Extrude {1, 0, 0} { Surface{face[1]}; Layers{40}; };
Physical Volume("column") = {body[1]};
Physical Surface("root") = {face[1]};
Physical Surface("tip") = {body[0]};
Mesh.ElementOrder = 2;
