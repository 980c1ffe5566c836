do for [i=1:3] { eval require(sprintf("curve-%d", i), 10) }
set xlabel "dimensionless time t"
set ylabel "peak amplitude A"
set xrange [0:3500]
set yrange [0:6.2]
plot for [i=1:3] table index sprintf("curve-%d", i) using 1:2 \
  with lines ls (word("2 1 3", i) + 0) title columnheader(2)
eval axes("t", "A", "")
