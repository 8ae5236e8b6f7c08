// A disc of radius 1 m and thickness 0.02 m, in one layer of tetrahedra.
SetFactory("OpenCASCADE");
Disk(1) = {0, 0, -0.01, 1, 1};
Point(100) = {0, 0, -0.01};
BooleanFragments{ Surface{1}; Delete; }{ Point{100}; Delete; }
body[] = Extrude {0, 0, 0.02} { Surface{1}; Layers{1}; };
Physical Volume("disc") = {body[1]};
Physical Surface("rim") = {body[2]};
Physical Surface("top") = {body[0]};
Mesh.MeshSizeMin = 0.12;
Mesh.MeshSizeMax = 0.12;
Mesh.ElementOrder = 2;
