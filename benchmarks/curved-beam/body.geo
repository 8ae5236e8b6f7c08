// A quarter of a ring about z, of radii 4.12 and 4.32 and 0.1 thick, in 30 x 4 x 2 bricks that are cut into tetrahedra.
Point(1) = {4.12, 0, -0.05};
line[] = Extrude {0.2, 0, 0} { Point{1}; Layers{4}; };
face[] = Extrude {0, 0, 0.1} { Line{line[1]}; Layers{2}; };
body[] = Extrude { {0, 0, 1}, {0, 0, 0}, Pi/2 } { Surface{face[1]}; Layers{30}; };
Physical Volume("beam") = {body[1]};
Physical Surface("root") = {face[1]};
Physical Surface("tip") = {body[0]};
Mesh.ElementOrder = 2;
