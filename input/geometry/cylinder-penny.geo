// Cylinder of radius 50 and length 90 mm with a penny-shaped crack of radius 10 mm, its normal
// 30 degrees from the axis: input/cylinder-penny.inp.
SetFactory("OpenCASCADE");
Cylinder(1) = {0, 0, -45, 0, 0, 90, 50};
Physical Volume("cylinder") = {1};
Disk(100) = {0, 0, 0, 10};
Rotate {{0, 1, 0}, {0, 0, 0}, Pi/6} { Surface{100}; }
Physical Surface("penny") = {100};
