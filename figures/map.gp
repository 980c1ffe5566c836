# A quantity of a sweep over two numbers of its grid: cells in a colour for their value, contours, the limits of the
# damper's regimes, the best point. Cells without a value have a mark instead of a colour.
load folder."/own.gp"
eval require("cells", 1)
header(name) = system(sprintf("sed -n 's/^# %s: //p' '%s'", name, table))
eval canvas(720, 620)
set tmargin at screen 0.875
set bmargin at screen 0.200
set rmargin at screen 0.815
# The colours of the map cividis: their lightness rises evenly, for all kinds of colour vision.
set palette defined (0 "#00224E", 1 "#123570", 2 "#3B496C", 3 "#575D6D", 4 "#707173", 5 "#8A8678", 6 "#A59C74", \
  7 "#C3B369", 8 "#E1CC55", 9 "#FEE838")
set palette maxcolors 0
low_x = 1e300; high_x = -1e300; low_y = 1e300; high_y = -1e300
do for [block in "cells empty failed"] {
  if (has(block)) {
    stats table index block using 3 nooutput; low_x = STATS_min < low_x ? STATS_min : low_x
    stats table index block using 4 nooutput; high_x = STATS_max > high_x ? STATS_max : high_x
    stats table index block using 5 nooutput; low_y = STATS_min < low_y ? STATS_min : low_y
    stats table index block using 6 nooutput; high_y = STATS_max > high_y ? STATS_max : high_y
  }
}
stats table index "cells" using 7 nooutput
set cbrange [STATS_min:STATS_max]
stats table index "logarithmic" using 1 nooutput
logarithmic = STATS_max > 0 ? "x" : ""
stats table index "logarithmic" using 2 nooutput
logarithmic = logarithmic.(STATS_max > 0 ? "y" : "")
# From here on stats would see only what is in these ranges.
set xrange [low_x:high_x]
set yrange [low_y:high_y]
if (strlen(logarithmic)) { eval "set logscale ".logarithmic }
if (strstrt(logarithmic, "x")) { eval marks("x", low_x, high_x) }
if (strstrt(logarithmic, "y")) { eval marks("y", low_y, high_y) }
set xlabel header("x") offset 0,0.3
set ylabel header("y")
set cblabel header("z") offset 1,0
set tics front
set style fill solid 1 noborder
set style textbox opaque noborder fillcolor rgb "white" margins 0.4,0.4
entries = has("empty") + has("failed") + has("failure") + has("bounce-down") + has("best")
set key at screen 0.48,screen 0.047 center maxrows (entries > 4 ? 3 : 2) samplen 2.4 Left reverse width -1 font ",12"
line(block, clause) = !has(block) ? "" : sprintf(", table index '%s' using 1:2 with lines lc rgb 'white' lw 4 notitle, '' index '%s' using 1:2 with lines ", block, block).clause." title columnheader(2)"
missing(block, mark, legend) = !has(block) ? "" : sprintf( \
  ", table index '%s' using 1:2:3:4:5:6 with boxxyerror fc rgb 'white' notitle, '' index '%s' using 1:2 with points pt %d ps 0.7 lc rgb grey title '%s'", \
  block, block, mark, legend)
eval "plot table index 'cells' using 1:2:3:4:5:6:7 with boxxyerror fc palette notitle".\
  missing("empty", 6, "no such value").missing("failed", 2, "run failed").\
  (!has("contours") ? "" : ", table index 'contours' using 1:2 with lines lc rgb 'white' lw 2.2 notitle, '' index 'contours' using 1:2 with lines lc rgb black lw 0.8 notitle").\
  line("failure", "lc rgb vermillion lw 2.2 dt (9,3)").line("bounce-down", "lc rgb vermillion lw 2.2 dt (2,3)").\
  (!has("levels") ? "" : ", table index 'levels' using 1:2:(sprintf('%g', $3)) with labels boxed font ',10' notitle").\
  (!has("best") ? "" : ", table index 'best' using 1:2 with points pt 7 ps 1.9 lc rgb 'white' notitle, '' index 'best' using 1:2 with points pt 7 ps 1.3 lc rgb vermillion title columnheader(2)")
eval axes(header("x"), header("y"), logarithmic)
