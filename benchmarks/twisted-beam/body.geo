// A beam of 12 along x, 1.1 x 0.32 at the root, twisted by 90 degrees about its line, in 24 x 4 x 2 bricks that are cut into tetrahedra.
Point(1) = {0, -0.55, -0.16};
line[] = Extrude {0, 1.1, 0} { Point{1}; Layers{4}; };
face[] = Extrude {0, 0, 0.32} { Line{line[1]}; Layers{2}; };
body[] = Extrude { {12, 0, 0}, {1, 0, 0}, {0, 0, 0}, Pi/2 } { Surface{face[1]}; Layers{24}; };
Physical Volume("beam") = {body[1]};
Physical Surface("root") = {face[1]};
Physical Surface("tip") = {body[0]};
Mesh.ElementOrder = 2;
