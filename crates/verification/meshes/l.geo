// An L in the plane z = 0 with legs of 1 and 0.6 along x and y, of square section 0.1; SI.
lc = 0.1;
Point(1) = {0, 0, 0}; Point(2) = {1, 0, 0}; Point(3) = {1, 0.1, 0};
Point(4) = {0.1, 0.1, 0}; Point(5) = {0.1, 0.6, 0}; Point(6) = {0, 0.6, 0};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 5}; Line(5) = {5, 6}; Line(6) = {6, 1};
Curve Loop(1) = {1, 2, 3, 4, 5, 6}; Plane Surface(1) = {1};
Mesh.MeshSizeMin = lc; Mesh.MeshSizeMax = lc;
out[] = Extrude {0, 0, 0.1} { Surface{1}; Layers{1}; };
Physical Volume("l") = {out[1]};
Physical Surface("end") = {out[6]};
Physical Surface("all") = {1, out[0], out[2], out[3], out[4], out[5], out[6], out[7]};
Mesh.ElementOrder = 2;
