// Rod of 50 x 50 x 100 mm with a quarter crack at the edge x = y = 0: input/rod-quarter.inp.
// The crack is a cylinder of radius 16 mm about that edge, cut by z = 8/sqrt(3) - (x + y)/sqrt(3).
SetFactory("OpenCASCADE");
Box(1) = {0, 0, -50, 50, 50, 100};
Physical Volume("rod") = {1};
s = Sqrt(3);
Point(101) = {0, 0, 8/s};
Point(102) = {16, 0, -8/s};
Point(103) = {0, 16, -8/s};
Point(104) = {16/Sqrt(2), 16/Sqrt(2), 8/s - 32/Sqrt(2)/s};
Line(101) = {101, 102};
Ellipse(102) = {102, 101, 104, 104};
Ellipse(103) = {104, 101, 104, 103};
Line(104) = {103, 101};
Curve Loop(100) = {101, 102, 103, 104};
Plane Surface(100) = {100};
Physical Surface("corner") = {100};
