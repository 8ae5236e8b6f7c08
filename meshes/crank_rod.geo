// The rod of a slider-crank, 300 x 8 x 8 mm, in bricks of 10 x 4 x 4 mm that are cut into tetrahedra; "crank" and "slider"
// are its end faces. Units: m.
Point(1) = {0, -0.004, -0.004};
line[] = Extrude {0, 0.008, 0} { Point{1}; Layers{2}; };
face[] = Extrude {0, 0, 0.008} { Line{line[1]}; Layers{2}; };
body[] = Extrude {0.3, 0, 0} { Surface{face[1]}; Layers{30}; };
Physical Volume("rod") = {body[1]};
Physical Surface("crank") = {face[1]};
Physical Surface("slider") = {body[0]};
Mesh.ElementOrder = 2;
