// A quarter of a ring about z, of radii 0.1 and 0.2 m, 0.02 m thick.
Point(1) = {0.1, 0, 0};
line[] = Extrude {0.1, 0, 0} { Point{1}; Layers{6}; };
face[] = Extrude {0, 0, 0.02} { Line{line[1]}; Layers{1}; };
body[] = Extrude { {0, 0, 1}, {0, 0, 0}, Pi/2 } { Surface{face[1]}; Layers{12}; };
Physical Volume("ring") = {body[1]};
Physical Surface("inside") = {body[5]};
Mesh.ElementOrder = 2;
