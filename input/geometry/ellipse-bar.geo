// A quarter of a bar of 300 x 120 x 180 mm with a quarter of an elliptical crack, semi-axes 20 along
// y and 35 mm along z: input/ellipse-bar.inp.
SetFactory("OpenCASCADE");
Box(1) = {-150, 0, 0, 300, 60, 90};
Physical Volume("bar") = {1};
Point(101) = {0, 0, 0};
Point(102) = {0, 20, 0};
Point(103) = {0, 0, 35};
Line(101) = {101, 102};
Ellipse(102) = {102, 101, 103, 103};
Line(103) = {103, 101};
Curve Loop(100) = {101, 102, 103};
Plane Surface(100) = {100};
Physical Surface("flaw") = {100};
