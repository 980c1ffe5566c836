# One panel for each set of dampers: their loss factor with the spread of the releases, beside the sum of what each would
# lose alone, and the amplitudes at which impacts of each fail.
panels = system(sprintf("grep -c -x '# set-[0-9]*' '%s' || true", table)) + 0
do for [i=1:panels] {
  eval require(sprintf("set-%d", i), 10)
  eval require(sprintf("sum-%d", i), 10)
  eval require(sprintf("dampers-%d", i), 1)
}
eval canvas(720, 900)
set multiplot
eval captioned
set logscale xy
set grid xtics ytics lc rgb "#D8D8D8" lw 0.5 dt 1
set tics scale 0.5 nomirror
set lmargin at screen 0.11
set rmargin at screen 0.97
set key at graph 0.62,graph 0.3 Left reverse samplen 3 width 1 font ",12"
set ylabel formula("η")." / Σ".formula("ν") offset 1,0
top(i) = 0.975 - 0.298 * (i - 1)
numbers = '"0.05" 0.05, "0.1" 0.1, "0.2" 0.2, "0.5" 0.5, "1" 1, "2" 2, "5" 5, "10" 10'
bare(numbers) = system(sprintf("printf '%%s' '%s' | sed 's/\"[^\"]*\"/\"\"/g'", numbers))
set ytics ("0.03" 0.03, "0.1" 0.1, "0.3" 0.3, "1" 1, "3" 3)
do for [i=1:panels] {
  set tmargin at screen top(i)
  set bmargin at screen top(i) - 0.275
  set xrange [0.045:11]
  set yrange [0.02:5]
  eval panel(substr("abcdefgh", i, i), top(i))
  if (i == panels) { set xlabel "amplitude ".formula("A").", divided by the least clearance" offset 0,0.3 } else { unset xlabel }
  eval "set xtics (".(i == panels ? numbers : bare(numbers)).")"
  plot table index sprintf("set-%d", i) using 1:3:4 with filledcurves lc rgb sky notitle, \
    table index sprintf("sum-%d", i) using 1:2 with lines lc rgb vermillion lw 1.6 dt (6,3) title columnheader(2), \
    table index sprintf("set-%d", i) using 1:2 with linespoints lc rgb black lw 1.6 pt 7 ps 0.4 title columnheader(2)
  eval axes("A", "η/Σν", "xy")
}
unset multiplot
