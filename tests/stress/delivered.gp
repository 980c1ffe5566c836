# Error of the restitution that central differences deliver, against steps per contact.
do for [block in "centred lagged centred-located lagged-located"] { eval require(block, 4) }
set logscale xy
set format y "10^{%T}"
set xrange [12:6000]
set xtics (16, 64, 256, 1024, 4096)
set mxtics 1
set xlabel "steps per contact"
set ylabel "largest error of the restitution, e = 0.6"
set key bottom left
plot table index "centred" using 1:2 with linespoints ls 1 title "centred damper", \
     table index "lagged" using 1:2 with linespoints ls 2 title "lagged damper", \
     table index "centred-located" using 1:2 with linespoints ls 3 title "centred, events located", \
     table index "lagged-located" using 1:2 with linespoints ls 4 title "lagged, events located", \
     0.3/x with lines ls 10 title "first and second order", 0.1/x**2 with lines ls 10 notitle
