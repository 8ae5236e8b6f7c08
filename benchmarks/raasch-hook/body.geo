// A hook, 20 wide along z and 2 thick: an arc of 60° about a radius of 14, then one of 150° the other way about a radius of 46.
Point(1) = {0, -1, 0};
line[] = Extrude {0, 2, 0} { Point{1}; Layers{1}; };
face[] = Extrude {0, 0, 20} { Line{line[1]}; Layers{8}; };
first[] = Extrude { {0, 0, 1}, {0, -14, 0}, -Pi/3 } { Surface{face[1]}; Layers{6}; };
second[] = Extrude { {0, 0, 1}, {60*Sin(Pi/3), 16, 0}, 5*Pi/6 } { Surface{first[0]}; Layers{30}; };
Physical Volume("hook") = {first[1], second[1]};
Physical Surface("root") = {face[1]};
Physical Surface("tip") = {second[0]};
Mesh.ElementOrder = 2;
