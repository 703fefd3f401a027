// As bending-2mm.geo, with the punch 20 mm to the left: input/bending-eccentric.inp.
aside = -20;
Include "bending-2mm.geo";
