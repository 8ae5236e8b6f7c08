// A shaft along x, of radius 25 mm and length 0.9 m, in 24 layers.
r = 0.025;
Point(1) = {0, 0, 0}; Point(2) = {0, r, 0}; Point(3) = {0, 0, r}; Point(4) = {0, -r, 0}; Point(5) = {0, 0, -r};
Circle(1) = {2, 1, 3}; Circle(2) = {3, 1, 4}; Circle(3) = {4, 1, 5}; Circle(4) = {5, 1, 2};
Transfinite Curve{1:4} = 4;
Curve Loop(1) = {1, 2, 3, 4}; Plane Surface(1) = {1};
Mesh.MeshSizeMax = 0.018;
out[] = Extrude {0.9, 0, 0} { Surface{1}; Layers{24}; };
Physical Volume("shaft") = {out[1]};
Physical Surface("left") = {1};
Physical Surface("right") = {out[0]};
Mesh.ElementOrder = 2;
