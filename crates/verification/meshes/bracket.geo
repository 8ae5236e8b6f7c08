// An L bracket: a leg of 0.6 along x from its root, then one of 0.5 along y; square section 0.02, SI.
Point(1) = {0, -0.01, -0.01};
line[] = Extrude {0, 0.02, 0} { Point{1}; Layers{1}; };
face[] = Extrude {0, 0, 0.02} { Line{line[1]}; Layers{1}; };
leg[] = Extrude {0.59, 0, 0} { Surface{face[1]}; Layers{12}; };
corner[] = Extrude {0.02, 0, 0} { Surface{leg[0]}; Layers{1}; };
up[] = Extrude {0, 0.49, 0} { Surface{corner[4]}; Layers{10}; };
Physical Volume("bracket") = {leg[1], corner[1], up[1]};
Physical Surface("root") = {face[1]};
Physical Surface("tip") = {up[0]};
Mesh.ElementOrder = 2;
