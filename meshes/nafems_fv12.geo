// The thin plate of NAFEMS FV12, 10 x 10 x 0.05 m, in 24 x 24 x 1 bricks that are cut into tetrahedra.
Point(1) = {0, 0, 0};
line[] = Extrude {10, 0, 0} { Point{1}; Layers{24}; };
face[] = Extrude {0, 10, 0} { Line{line[1]}; Layers{24}; };
body[] = Extrude {0, 0, 0.05} { Surface{face[1]}; Layers{1}; };
Physical Volume("plate") = {body[1]};
Mesh.ElementOrder = 2;
