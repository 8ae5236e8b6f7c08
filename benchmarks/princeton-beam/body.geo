// A beam of 0.508 x 0.0123777 x 0.0032024 m along x, about the x-axis, in 40 x 2 x 1 bricks that are cut into tetrahedra.
Point(1) = {0, -0.00618885, -0.0016012};
line[] = Extrude {0, 0.0123777, 0} { Point{1}; Layers{2}; };
face[] = Extrude {0, 0, 0.0032024} { Line{line[1]}; Layers{1}; };
body[] = Extrude {0.508, 0, 0} { Surface{face[1]}; Layers{40}; };
Physical Volume("beam") = {body[1]};
Physical Surface("root") = {face[1]};
Physical Surface("tip") = {body[0]};
Mesh.ElementOrder = 2;
