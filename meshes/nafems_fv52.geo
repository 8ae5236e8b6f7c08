// The thick plate of NAFEMS FV52, 10 x 10 x 1 m, in 8 x 8 x 1 bricks that are cut into tetrahedra.
Point(1) = {0, 0, 0};
line[] = Extrude {10, 0, 0} { Point{1}; Layers{8}; };
face[] = Extrude {0, 10, 0} { Line{line[1]}; Layers{8}; };
body[] = Extrude {0, 0, 1} { Surface{face[1]}; Layers{1}; };
// The lower edges, on which the plate stands.
Physical Curve("edges") = {line[1], 2, 3, 4};
Physical Volume("plate") = {body[1]};
Mesh.ElementOrder = 2;
