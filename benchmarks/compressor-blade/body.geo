// A panel of a cylinder about z, of radius 609.6 mm, 0.5 rad wide, 304.8 mm long and 3.048 mm thick, in 14 x 14 x 1 bricks that are cut into tetrahedra.
Point(1) = {0.608076, 0, 0};
line[] = Extrude {0.003048, 0, 0} { Point{1}; Layers{1}; };
face[] = Extrude {0, 0, 0.3048} { Line{line[1]}; Layers{14}; };
body[] = Extrude { {0, 0, 1}, {0, 0, 0}, 0.5 } { Surface{face[1]}; Layers{14}; };
Physical Volume("blade") = {body[1]};
Mesh.ElementOrder = 2;
