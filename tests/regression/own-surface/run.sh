#!/usr/bin/env bash
# A front that runs into the surface of its own crack: the nodes that meet it stop, the log says where,
# the others go on, and the run ends as it should.
# ranks: 1 2
# shellcheck source=../case.sh
source "$(dirname "$0")/../case.sh"

# patch X Y Z AX AY AZ BX BY BZ N: n by n squares of triangles from a corner along two sides.
patch() {
   awk -v x="$1" -v y="$2" -v z="$3" -v ax="$4" -v ay="$5" -v az="$6" -v bx="$7" -v by="$8" -v bz="$9" \
      -v n="${10}" 'function p(i, j) { printf "vertex %.9g %.9g %.9g\n",
         x + (i*ax + j*bx)/n, y + (i*ay + j*by)/n, z + (i*az + j*bz)/n }
      function t(i, j, k, l, m, o) { print "facet normal 0 0 0\nouter loop"; p(i, j); p(k, l); p(m, o)
         print "endloop\nendfacet" }
      BEGIN { for (i = 0; i < n; i++) for (j = 0; j < n; j++) {
         t(i, j, i + 1, j, i + 1, j + 1); t(i, j, i + 1, j + 1, i, j + 1) } }'
}
{
   echo 'solid parts'
   patch -14 -1 0.3 10 0 0 0 10 0 10
   patch -0.5 -1 -8 5 10 0 0 0 16 16
   echo 'endsolid parts'
} >parts.stl
cp "$here/deck.inp" .
run_deck "$ranks" out deck.inp
expect_text out/own.log 'it would grow into its own surface' "crack 'parts': stopped at"
# The wall is x = -0.5 + (y + 1)/2; vertices of the plane that grew follow those of the file.
x='crack["x"][410:]'
gap="((-0.5 + 0.5*(${x}[:, 1] + 1) - ${x}[:, 0])/np.sqrt(1.25))"
inside="((${x}[:, 1] > 0) & (${x}[:, 1] < 8))"
compare check out/own <<TABLE
least distance of the front from the wall | ${gap}[$inside].min() | 1.25 | 0.26 | a cell, and less than an increment of half a cell
way of the front at the far side, where the wall is 4 mm further | ${x}[$inside, 0].max() | 2.35 | 0.4 | at y = 7.5, 1 to 1.5 cells from the wall: it went on when the other side had stopped
way of the front, off its plane | np.abs(${x}[:, 2] - 0.3).max() | 0 | 0.05 | strain
TABLE
finish
