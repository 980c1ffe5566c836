# Run time against error: scenes S1 and S2 on the left, S3 on the right.
do for [block in "S1-exact S2-restitution S3-exact S3-restitution"] { eval require(block, 1) }
do for [block in "S1-cem S1-cem-located S3-cem S3-cem-located"] { eval require(block, 3) }

eval canvas(1080, 520)
set output output
set multiplot layout 1,2 title title."\n{/*0.82 ".parameters."}" font ",15" offset 0,-0.2 margins 0.08,0.985,0.13,0.83 spacing 0.07
set logscale xy
set format "10^{%T}"
set xrange [1e-16:1]
set yrange [1e3:1e8]
set xtics 1e-16,100,1
set ytics 10
set mxtics 1
set key bottom right
set grid lc rgb pale lt 1
set xlabel "error: largest difference of a half-cycle amplitude"
# What two recorded amplitudes can differ by at all; an error below it is drawn at it.
floor_of(error) = error > 4.4e-16 ? error : 4.4e-16
point(block, style, name) = sprintf( \
  "table index '%s' using (floor_of($1)):2 with points ls %d ps 1.2 title '%s'", block, style, name)
curve(block, style, name) = sprintf( \
  "table index '%s' using (floor_of($1)):2 with linespoints ls %d title '%s'", block, style, name)

set title "x_0 = 4.5 to t = 100 (S1, restitution S2)" font ",13"
set ylabel "run time in yardsticks"
eval "plot ".point("S1-exact", 1, "exact").",".point("S2-restitution", 4, "restitution").",". \
  curve("S1-cem", 3, "component element method").",".curve("S1-cem-located", 2, "the same, events located")
set title "x_0 = 6 to t = 400: bounce-down and stuck (S3)" font ",13"
unset ylabel
unset key
eval "plot ".point("S3-exact", 1, "exact").",".point("S3-restitution", 4, "restitution").",". \
  curve("S3-cem", 3, "").",".curve("S3-cem-located", 2, "")
unset multiplot
