// A cube of 1 m in 6 x 6 x 6 bricks that are cut into tetrahedra.
Point(1) = {0, 0, 0};
line[] = Extrude {1, 0, 0} { Point{1}; Layers{6}; };
face[] = Extrude {0, 1, 0} { Line{line[1]}; Layers{6}; };
body[] = Extrude {0, 0, 1} { Surface{face[1]}; Layers{6}; };
Physical Volume("cube") = {body[1]};
Mesh.ElementOrder = 2;
