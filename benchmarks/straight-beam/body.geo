// A beam of 6 x 0.2 x 0.1 in 24 x 4 x 2 bricks that are cut into tetrahedra.
Point(1) = {0, -0.1, -0.05};
line[] = Extrude {0, 0.2, 0} { Point{1}; Layers{4}; };
face[] = Extrude {0, 0, 0.1} { Line{line[1]}; Layers{2}; };
body[] = Extrude {6, 0, 0} { Surface{face[1]}; Layers{24}; };
Physical Volume("beam") = {body[1]};
Physical Surface("root") = {face[1]};
Physical Surface("tip") = {body[0]};
Mesh.ElementOrder = 2;
