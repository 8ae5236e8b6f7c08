// A beam of 10 x 2 x 2 m along x, in 15 x 3 x 3 bricks that are cut into tetrahedra.
Point(1) = {0, -1, -1};
line[] = Extrude {0, 2, 0} { Point{1}; Layers{3}; };
face[] = Extrude {0, 0, 2} { Line{line[1]}; Layers{3}; };
body[] = Extrude {10, 0, 0} { Surface{face[1]}; Layers{15}; };
Physical Volume("beam") = {body[1]};
Physical Surface("a") = {face[1]};
Physical Surface("b") = {body[0]};
Mesh.ElementOrder = 2;
