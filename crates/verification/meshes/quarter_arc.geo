// A quarter of a circle of radius 0.8, that begins along y and bends towards z; section 0.024 x 0.018, SI.
Point(1) = {-0.012, 0, -0.009};
line[] = Extrude {0.024, 0, 0} { Point{1}; Layers{1}; };
face[] = Extrude {0, 0, 0.018} { Line{line[1]}; Layers{1}; };
body[] = Extrude { {1, 0, 0}, {0, 0, 0.8}, Pi/2 } { Surface{face[1]}; Layers{18}; };
Physical Volume("arc") = {body[1]};
Physical Surface("root") = {face[1]};
Physical Surface("tip") = {body[0]};
Mesh.ElementOrder = 2;
