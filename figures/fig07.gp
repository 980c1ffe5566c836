# Above what the paper draws. Below the same decays over nu t, where they nearly coincide, and the straight line of a
# constant product A eta / nu.
do for [i=1:3] { eval require(sprintf("curve-%d", i), 10) }
eval require("law", 3)
eval require("line", 2)
eval canvas(720, 860)
set lmargin at screen 0.115
set rmargin at screen 0.975
eval captioned
set multiplot
eval panel("a", 0.975)
set tmargin at screen 0.975
set bmargin at screen 0.580
set xlabel "dimensionless time ".formula("t")
set ylabel "peak amplitude ".formula("A")
set xrange [0:3500]
set yrange [0:6.2]
plot for [i=1:3] table index sprintf("curve-%d", i) using 1:2 \
  with lines ls (word("2 1 3", i) + 0) title legend(columnheader(2))
eval axes("t", "A", "")

eval panel("b", 0.480)
set tmargin at screen 0.480
set bmargin at screen 0.090
set xlabel "dimensionless time times mass ratio, ".formula("ν t")
set xrange [0:40]
# Times are multiplied by the mass ratio of the curve, row i of the block "law" below its headings.
array nu[3]
do for [i=1:3] { stats table index "law" using 1 every ::i::i nooutput; nu[i] = STATS_max }
plot for [i=1:3] table index sprintf("curve-%d", i) using (nu[i] * $1):2 \
  with lines ls (word("2 1 3", i) + 0) title legend(columnheader(2)), \
  table index "line" using 1:2 with lines ls 9 title "d".formula("A")."/d".formula("t").formula(columnheader(2)[6:*])
eval axes("ν t", "A", "")
unset multiplot
