// Tube with radii of 35 and 45 and a length of 100 mm, a crack of 14.14 mm through its wall at 45
// degrees to the axis: input/tube-crack.inp. The crack reaches out of the wall by itself.
SetFactory("OpenCASCADE");
Cylinder(1) = {0, 0, -50, 0, 0, 100, 45};
Cylinder(2) = {0, 0, -50, 0, 0, 100, 35};
BooleanDifference(3) = { Volume{1}; Delete; }{ Volume{2}; Delete; };
Physical Volume("tube") = {3};
Rectangle(100) = {-5*Sqrt(2), -9, 0, 10*Sqrt(2), 18};
// The width along (0, 1, 1), the depth along x.
Rotate {{0, 0, 1}, {0, 0, 0}, -Pi/2} { Surface{100}; }
Rotate {{1, 0, 0}, {0, 0, 0}, -3*Pi/4} { Surface{100}; }
Translate {40, 0, 0} { Surface{100}; }
Physical Surface("slit") = {100};
