// A slender square bar, 400 x 10 x 10 mm, in bricks of 10 x 5 x 5 mm that are cut into tetrahedra; "root" is the end
// at x = 0, nodes on the line y = z = 0 through the middle.
Point(1) = {0, -5, -5};
line[] = Extrude {0, 10, 0} { Point{1}; Layers{2}; };
face[] = Extrude {0, 0, 10} { Line{line[1]}; Layers{2}; };
body[] = Extrude {400, 0, 0} { Surface{face[1]}; Layers{40}; };
Physical Volume("bar") = {body[1]};
Physical Surface("root") = {face[1]};
Mesh.ElementOrder = 2;
