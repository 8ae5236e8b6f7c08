// An L bracket: a leg of 0.6 along x from its root, then one of 0.5 along y; square section 0.02, SI.
Point(1) = {0, -0.01, -0.01}; Point(2) = {0.61, -0.01, -0.01}; Point(3) = {0.61, 0.5, -0.01};
Point(4) = {0.59, 0.5, -0.01}; Point(5) = {0.59, 0.01, -0.01}; Point(6) = {0, 0.01, -0.01};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 5}; Line(5) = {5, 6}; Line(6) = {6, 1};
Curve Loop(1) = {1, 2, 3, 4, 5, 6}; Plane Surface(1) = {1};
Mesh.MeshSizeMin = 0.035; Mesh.MeshSizeMax = 0.035;
out[] = Extrude {0, 0, 0.02} { Surface{1}; Layers{1}; };
Physical Volume("bracket") = {out[1]};
Physical Surface("root") = {out[7]};
Physical Surface("tip") = {out[4]};
Mesh.ElementOrder = 2;
