// As bending-2mm.geo, with a punch that is 10 mm wide: input/bending-5mm.inp.
half = 5;
Include "bending-2mm.geo";
