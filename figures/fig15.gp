# The whole decay above, its last tenth below, where impacts become single and then fail.
do for [b in "impacts stuck windows"] { eval require(b, 1) }
do for [b in "one-impact bounce-1 bounce-2 bounce-3 bounce-4 accumulation"] { eval require(b, 10) }
eval canvas(720, 760)
set ylabel "phase of impact in degrees" offset 1,0
set yrange [0:180]
set ytics 30
set mytics 3
set lmargin at screen 0.105
set rmargin at screen 0.975
dark = "#BDBDBD"

eval captioned
set multiplot
eval panel("a", 0.975)
set tmargin at screen 0.975
set bmargin at screen 0.480
set xrange [0:6]
set xtics 1
set mxtics 5
# The regular windows as bars low in the picture, where few impacts fall, each with its number.
set key at graph 0.985, 0.125 right bottom maxrows 2 width 0
plot table index "stuck" using 1:2:3 with filledcurves lc rgb dark title "stuck", \
     table index "stuck" using 1:2:(0):($3-$2) with vectors nohead lc rgb dark lw 1 notitle, \
     table index "impacts" using 1:2 with points pt 5 ps 0.17 lc rgb black title "impacts", \
     table index "windows" using 2:(8):($3-$2):(0) with vectors nohead lc rgb green lw 4 title "impacts per half cycle", \
     table index "windows" using (($2+$3)/2):(17):1 with labels font ",12" notitle, \
     for [i=1:4] table index sprintf("bounce-%d", i) using 1:2 with lines ls 9 notitle, \
     table index "accumulation" using 1:2 with lines ls 9 title "closed forms, ".formula("ν")." → 0", \
     table index "one-impact" using 1:2 with lines ls 9 notitle
eval axes("A", "phase", "")

unset label
eval panel("b", 0.425)
unset key
set tmargin at screen 0.425
set bmargin at screen 0.085
set xrange [0:0.6]
set xtics 0.1
set mxtics 5
set xlabel "peak amplitude ".formula("A")." of the half cycle"
plot table index "impacts" using 1:2 with points pt 5 ps 0.25 lc rgb black, \
     table index "windows" using 2:(8):($3-$2):(0) with vectors nohead lc rgb green lw 4, \
     table index "one-impact" using 1:2 with lines ls 9
eval axes("A", "phase", "")
unset multiplot
