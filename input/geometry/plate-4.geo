// Plate of 400 x 120 x 10 mm with 4 of the inclined cracks of input/plate-4.inp.
SetFactory("OpenCASCADE");
Box(1) = {-200, -60, -6, 400, 120, 10};
Physical Volume("plate") = {1};
middles[] = {-150, -50, 50, 150};
slope = Atan(2);
For i In {0 : #middles[] - 1}
  // 40 mm long and as deep as the plate is thick, turned upright and by the slope.
  Rectangle(100 + i) = {-20, -5, 0, 40, 10};
  Rotate {{1, 0, 0}, {0, 0, 0}, Pi/2} { Surface{100 + i}; }
  Rotate {{0, 0, 1}, {0, 0, 0}, slope} { Surface{100 + i}; }
  Translate {middles[i], 0, -1} { Surface{100 + i}; }
  Physical Surface(Sprintf("slit-%g", i + 1)) = {100 + i};
EndFor
