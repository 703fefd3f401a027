// Beam of 400 x 100 x 10 mm with an edge crack of 50 mm, and a punch that is 4 mm wide:
// input/bending-2mm.inp.
SetFactory("OpenCASCADE");
DefineConstant[ half = 2, aside = 0 ];
Box(1) = {-200, 0, 0, 400, 100, 10};
Box(2) = {aside - half, 100, 0, 2*half, 50, 10};
Physical Volume("beam") = {1};
Physical Volume("punch") = {2};
Point(101) = {0, 0, 0};
Point(102) = {0, 50, 0};
Point(103) = {0, 50, 10};
Point(104) = {0, 0, 10};
Line(101) = {101, 102};
Line(102) = {102, 103};
Line(103) = {103, 104};
Line(104) = {104, 101};
Curve Loop(100) = {101, 102, 103, 104};
Plane Surface(100) = {100};
Physical Surface("notch") = {100};
