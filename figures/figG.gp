# One damper and a designed set of the same mass: loss factor over amplitude, the set's with the spread of its releases and
# what its design predicts.
eval require("set-1", 10)
eval require("set-2", 10)
eval require("sum-2", 10)
set logscale xy
set xrange [0.045:11]
set yrange [0.01:12]
set grid xtics ytics lc rgb "#D8D8D8" lw 0.5 dt 1
set xlabel "amplitude ".formula("A").", divided by ".formula("ε")
eval captioned
set ylabel formula("η")." / Σ".formula("ν")
set xtics ("0.05" 0.05, "0.1" 0.1, "0.2" 0.2, "0.5" 0.5, "1" 1, "2" 2, "5" 5, "10" 10)
set ytics ("0.01" 0.01, "0.03" 0.03, "0.1" 0.1, "0.3" 0.3, "1" 1, "3" 3, "10" 10)
set key top right Left reverse samplen 3 width 1
plot table index "set-2" using 1:3:4 with filledcurves lc rgb sky notitle, \
  table index "set-1" using 1:2 with linespoints lc rgb blue lw 1.6 dt (9,3) pt 4 ps 0.5 title columnheader(2), \
  table index "sum-2" using 1:2 with lines lc rgb vermillion lw 1.6 dt (6,3) title columnheader(2), \
  table index "set-2" using 1:2 with linespoints lc rgb black lw 1.6 pt 7 ps 0.4 title columnheader(2)
eval axes("A", "η/Σν", "xy")
