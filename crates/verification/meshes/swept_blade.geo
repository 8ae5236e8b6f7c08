// A swept blade: an arc of 35 degrees and of radius 1.6, that begins along y and bends towards z; section 0.03 x 0.02, SI.
Point(1) = {-0.015, 0, -0.01};
line[] = Extrude {0.03, 0, 0} { Point{1}; Layers{1}; };
face[] = Extrude {0, 0, 0.02} { Line{line[1]}; Layers{1}; };
body[] = Extrude { {1, 0, 0}, {0, 0, 1.6}, 35*Pi/180 } { Surface{face[1]}; Layers{14}; };
Physical Volume("blade") = {body[1]};
Physical Surface("root") = {face[1]};
Physical Surface("tip") = {body[0]};
Mesh.ElementOrder = 2;
