// Half of the slender bar, 200 x 10 x 10 mm, in bricks of 10 x 5 x 5 mm that are cut into tetrahedra; "left" and "right" are its
// end faces.
Point(1) = {0, -5, -5};
line[] = Extrude {0, 10, 0} { Point{1}; Layers{2}; };
face[] = Extrude {0, 0, 10} { Line{line[1]}; Layers{2}; };
body[] = Extrude {200, 0, 0} { Surface{face[1]}; Layers{20}; };
Physical Volume("bar") = {body[1]};
Physical Surface("left") = {face[1]};
Physical Surface("right") = {body[0]};
Mesh.ElementOrder = 2;
