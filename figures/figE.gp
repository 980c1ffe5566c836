# The map: a cell for each point, in the colour of its motion, with a mark that tells it in grey.
eval require("cell", 1)
stats table index "cell" using 1 nooutput
width = STATS_max / 2
stats table index "cell" using 2 nooutput
height = STATS_max / 2
regimes = "one-symmetric one-asymmetric each-2 each-3 other irregular idle"
colours = "#0072B2 #56B4E9 #009E73 #E69F00 #CC79A7 #F0F0F0 #FFFFFF"
eval canvas(720, 620)
low_x = 1e9; high_x = -1e9; low_y = 1e9; high_y = -1e9
there = ""
do for [i=1:words(regimes)] {
  block = word(regimes, i)
  if (has(block)) {
    eval require(block, 1)
    there = there." ".i
    stats table index block using 1 nooutput
    low_x = STATS_min < low_x ? STATS_min : low_x; high_x = STATS_max > high_x ? STATS_max : high_x
    stats table index block using 2 nooutput
    low_y = STATS_min < low_y ? STATS_min : low_y; high_y = STATS_max > high_y ? STATS_max : high_y
  }
}
set xrange [low_x - width:high_x + width]
set yrange [low_y - height:high_y + height]
eval captioned
set xlabel "frequency ".formula("ω")." of the force"
set ylabel "amplitude ".formula("f₀/ν")." of the force"
set tics front
set style fill solid 1 noborder
set bmargin at screen 0.200
set key at screen 0.5,screen 0.055 center maxrows 2 samplen 1.5 Left reverse width 1 font ",12"
# Boxes first, then the marks that tell them apart in grey.
marks = "7 6 4 8 2 0 1"
box(i) = sprintf('table index "%s" using 1:2:(width):(height) with boxxyerror fc rgb "%s" title columnheader(2)', word(regimes, i), word(colours, i))
mark(i) = sprintf('table index "%s" using 1:2 with points pt %s ps 0.3 lc rgb "%s" notitle', \
  word(regimes, i), word(marks, i), i == 1 ? "white" : "black")
drawn = ""
do for [i in there] { drawn = drawn.(strlen(drawn) ? ", " : "").box(i + 0) }
do for [i in there] { drawn = drawn.", ".mark(i + 0) }
eval 'plot '.drawn
eval axes("ω", "f₀/ν", "")
