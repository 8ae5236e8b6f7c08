// A tuning fork of steel: two prongs of 88 x 5 x 6 mm on a bow, with a handle. Units: mm.
SetFactory("OpenCASCADE");
prong = 88;   // length of a prong
gap = 8;      // between the prongs
width = 5;    // of a prong, in the direction in which it swings
depth = 6;
// Prongs point along x. The bow is half of a ring.
Box(1) = {0, gap / 2, 0, prong, width, depth};
Box(2) = {0, -gap / 2 - width, 0, prong, width, depth};
Cylinder(3) = {0, 0, 0, 0, 0, depth, gap / 2 + width};
Cylinder(4) = {0, 0, 0, 0, 0, depth, gap / 2};
BooleanDifference(5) = { Volume{3}; Delete; }{ Volume{4}; Delete; };
Box(6) = {0, -50, 0, 50, 100, depth};
BooleanDifference(7) = { Volume{5}; Delete; }{ Volume{6}; Delete; };
Box(8) = {-gap / 2 - width - 35, -3, 0, 36, 6, depth};
BooleanUnion(9) = { Volume{1}; Delete; }{ Volume{2, 7, 8}; Delete; };
Physical Volume("fork") = {9};
