# Six panels, one for each restitution: the loss factor over the amplitude for five mass ratios, the amplitudes at which
# impacts fail and bounce-down ends, and the example that the report reads off.
panels = system(sprintf("grep -c -x '# panel-[0-9]*' '%s' || true", table)) + 0
curves = 5
eval require("reading", 1)
stats table index "reading" using 3 nooutput
example = STATS_max
do for [i=1:panels] {
  eval require(sprintf("panel-%d", i), 1)
  do for [j=1:curves] { eval require(sprintf("curve-%d-%d", i, j), 10) }
}
eval canvas(720, 1040)
set style line 1 lc rgb green      lw 1.6 dt (3,2.5)
set style line 2 lc rgb blue       lw 1.6 dt (9,3)
set style line 3 lc rgb black      lw 1.6 dt 1
set style line 4 lc rgb vermillion lw 1.6 dt (9,3,2,3)
set style line 5 lc rgb purple     lw 1.6 dt (14,3)
set multiplot
eval captioned
unset key
set logscale xy
set xrange [0.0115:11.5]
set yrange [4e-5:0.35]
set grid xtics ytics lc rgb "#D8D8D8" lw 0.5 dt 1
set tics scale 0.5 nomirror
left(i) = i % 2 ? 0.130 : 0.562
top(i) = 0.985 - 0.298 * ((i - 1) / 2)
numbers_x = '"0.02" 0.02, "0.05" 0.05, "0.1" 0.1, "0.2" 0.2, "0.5" 0.5, "1" 1, "2" 2, "5" 5, "10" 10'
numbers_y = '"" 5e-5, "0.0001" 1e-4, "" 2e-4, "" 5e-4, "0.001" 1e-3, "" 2e-3, "" 5e-3, "0.01" 0.01, "" 0.02, "" 0.05, "0.1" 0.1, "" 0.2'
bare(numbers) = system(sprintf("printf '%%s' '%s' | sed 's/\"[^\"]*\"/\"\"/g'", numbers))
# A line across the panel, named along it, where the table has it.
limit(block, tag, words, away, height, side) = !has(block) ? sprintf("unset arrow %d; unset label %d", tag, tag) : sprintf( \
  "stats table index '%s' using 1 nooutput; set arrow %d from STATS_max,graph 0 to STATS_max,graph 1 nohead ls 10 dt (6,4);".\
  "set label %d '%s' at STATS_max,graph %g %s rotate by 90 offset %g,0 font ',9' textcolor rgb grey", block, tag, tag, words, height, side, away)
do for [i=1:panels] {
  unset xrange; unset yrange; set autoscale
  eval limit(sprintf("failure-%d", i), 3, "impacts fail", -0.7, 0.03, "left")
  # Where no curve is: below them on one side of the line or, where it stands far to the right, above them.
  eval limit(sprintf("bounce-down-%d", i), 4, "bounce-down ends", i == 3 ? -0.7 : 0.7, i < 4 ? 0.03 : 0.88, i < 4 ? "left" : "right")
  stats table index sprintf("panel-%d", i) using 1 nooutput
  is_example = STATS_max == example
  set label 1 sprintf("(%s)  {/:Italic e} = %g", substr("abcdef", i, i), STATS_max) at graph 0.96,graph 0.92 right font ",14"
  set xrange [0.0115:11.5]
  set yrange [4e-5:0.35]
  set lmargin at screen left(i)
  set rmargin at screen left(i) + 0.413
  set tmargin at screen top(i)
  set bmargin at screen top(i) - 0.281
  if (i > panels - 2) { set xlabel "amplitude ".formula("A").", in clearances" offset 0,0.3 } else { unset xlabel }
  if (i % 2) { set ylabel "loss factor ".formula("η") offset 1.8,0 } else { unset ylabel }
  eval "set xtics (".(i > panels - 2 ? numbers_x : bare(numbers_x)).")"
  eval "set ytics (".(i % 2 ? numbers_y : bare(numbers_y)).")"
  eval 'plot for [j=1:curves] table index sprintf("curve-%d-%d", i, j) using 1:2 with lines ls j'.\
    (is_example ? ', table index "reading" using 1:2 with points pt 6 ps 1.4 lw 1.6 lc rgb black' : "")
  eval axes("A", "η", "xy")
}
# One key for all.
unset title
unset label
unset arrow
unset border
unset tics
unset grid
unset xlabel
unset ylabel
unset logscale
set lmargin at screen 0.02
set rmargin at screen 0.98
set tmargin at screen 0.045
set bmargin at screen 0.015
set key inside center center maxrows 1 samplen 2.6 Left reverse width 1 font ",12"
set xrange [0:1]
set yrange [0:1]
plot for [j=1:curves] table index sprintf("curve-1-%d", j) using (NaN):2 with lines ls j title legend(columnheader(2))
unset multiplot
