// A ring about z, of mean radius 100 mm, 5 mm radial and 10 mm axial.
Point(1) = {0.0975, 0, -0.005};
line[] = Extrude {0.005, 0, 0} { Point{1}; Layers{2}; };
face[] = Extrude {0, 0, 0.01} { Line{line[1]}; Layers{2}; };
a[] = Extrude { {0, 0, 1}, {0, 0, 0}, Pi/2 } { Surface{face[1]}; Layers{18}; };
b[] = Extrude { {0, 0, 1}, {0, 0, 0}, Pi/2 } { Surface{a[0]}; Layers{18}; };
c[] = Extrude { {0, 0, 1}, {0, 0, 0}, Pi/2 } { Surface{b[0]}; Layers{18}; };
d[] = Extrude { {0, 0, 1}, {0, 0, 0}, Pi/2 } { Surface{c[0]}; Layers{18}; };
Physical Volume("ring") = {a[1], b[1], c[1], d[1]};
Mesh.ElementOrder = 2;
