// A segment of 2.5 m along x with a square section of side √0.012 m, in 8 layers.
Point(1) = {0, -0.05477225575051661, -0.05477225575051661};
line[] = Extrude {0, 0.10954451150103323, 0} { Point{1}; Layers{1}; };
face[] = Extrude {0, 0, 0.10954451150103323} { Line{line[1]}; Layers{1}; };
body[] = Extrude {2.5, 0, 0} { Surface{face[1]}; Layers{8}; };
Physical Volume("segment") = {body[1]};
Physical Surface("root") = {face[1]};
Physical Surface("tip") = {body[0]};
Mesh.ElementOrder = 2;
