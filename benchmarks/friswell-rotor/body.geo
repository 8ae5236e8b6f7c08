// A shaft along x, 1.5 m long and 50 mm thick, in layers of 49 mm; rings of 20 mm about 0.5 and 1 m carry discs.
r = 0.025;
Point(1) = {0, 0, 0}; Point(2) = {0, r, 0}; Point(3) = {0, 0, r}; Point(4) = {0, -r, 0}; Point(5) = {0, 0, -r};
Circle(1) = {2, 1, 3}; Circle(2) = {3, 1, 4}; Circle(3) = {4, 1, 5}; Circle(4) = {5, 1, 2};
Transfinite Curve{1:4} = 3;
Curve Loop(1) = {1, 2, 3, 4}; Plane Surface(1) = {1};
Mesh.MeshSizeMax = 0.03;
a[] = Extrude {0.49, 0, 0} { Surface{1}; Layers{10}; };
b[] = Extrude {0.02, 0, 0} { Surface{a[0]}; Layers{1}; };
c[] = Extrude {0.48, 0, 0} { Surface{b[0]}; Layers{10}; };
d[] = Extrude {0.02, 0, 0} { Surface{c[0]}; Layers{1}; };
e[] = Extrude {0.49, 0, 0} { Surface{d[0]}; Layers{10}; };
Physical Volume("shaft") = {a[1], b[1], c[1], d[1], e[1]};
Physical Surface("left") = {1};
Physical Surface("right") = {e[0]};
Physical Surface("first") = {b[2], b[3], b[4], b[5]};
Physical Surface("second") = {d[2], d[3], d[4], d[5]};
Mesh.ElementOrder = 2;
