// A rod of 1 x 0.02 x 0.02 along x from its origin, about the x-axis; SI. Nodes lie on the line y = z = 0 through it.
Point(1) = {0, -0.01, -0.01};
line[] = Extrude {0, 0.02, 0} { Point{1}; Layers{2}; };
face[] = Extrude {0, 0, 0.02} { Line{line[1]}; Layers{2}; };
body[] = Extrude {1, 0, 0} { Surface{face[1]}; Layers{20}; };
Physical Volume("rod") = {body[1]};
Physical Surface("root") = {face[1]};
Physical Surface("tip") = {body[0]};
Physical Surface("all") = {face[1], body[0], body[2], body[3], body[4], body[5]};
Mesh.ElementOrder = 2;
