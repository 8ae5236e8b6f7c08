// A T-handle of aluminium: a cross bar of 200 x 4 x 10 mm along x, and a stem of 70 x 9 x 9 mm along y. Units: mm.
SetFactory("OpenCASCADE");
Box(1) = {-100, -2, -5, 200, 4, 10};
Box(2) = {-4.5, 0, -4.5, 9, 70, 9};
BooleanUnion(3) = { Volume{1}; Delete; }{ Volume{2}; Delete; };
Physical Volume("handle") = {3};
