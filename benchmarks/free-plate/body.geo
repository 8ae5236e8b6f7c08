// A plate of 4 x 1 x 0.1 m in 20 x 5 x 1 bricks that are cut into tetrahedra.
Point(1) = {0, 0, 0};
line[] = Extrude {4, 0, 0} { Point{1}; Layers{20}; };
face[] = Extrude {0, 1, 0} { Line{line[1]}; Layers{5}; };
body[] = Extrude {0, 0, 0.1} { Surface{face[1]}; Layers{1}; };
Physical Volume("plate") = {body[1]};
Mesh.ElementOrder = 2;
