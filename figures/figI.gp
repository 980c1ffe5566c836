# One panel for each component: A eta / nu over the amplitude and, as triangles, the amplitudes below which it holds the mass.
counts = ""
do for [p=1:4] { counts = counts." ".system(sprintf("grep -c -x '# curve-%d-[0-9]*' '%s' || true", p, table)) }
count(p) = word(counts, p) + 0
do for [p=1:4] { do for [j=1:count(p)] { eval require(sprintf("curve-%d-%d", p, j), 10) } }
eval canvas(720, 1180)
set style line 1 lc rgb black      lw 1.8 dt 1           pt 7 ps 0.4
set style line 2 lc rgb blue       lw 1.6 dt (9,3)       pt 4 ps 0.5
set style line 3 lc rgb vermillion lw 1.6 dt (9,3,2,3)   pt 8 ps 0.6
set style line 4 lc rgb green      lw 1.6 dt (3,2.5)     pt 6 ps 0.5
set style line 5 lc rgb purple     lw 1.6 dt (14,3)      pt 12 ps 0.6
set style line 6 lc rgb orange     lw 1.6 dt 1           pt 2 ps 0.5
# "φ = 0.05" with its symbol in italics; a word as it is.
symbol(s) = strstrt(s, " = ") ? "{/:Italic ".s[1:1]."}".s[2:strlen(s)] : s
set multiplot
eval captioned
set logscale x
set xrange [0.05:3]
set yrange [0:0.65]
set grid xtics ytics lc rgb "#D8D8D8" lw 0.5 dt 1
set tics scale 0.5 nomirror
set lmargin at screen 0.11
set rmargin at screen 0.97
set key top right horizontal maxrows 1 Left reverse samplen 2.5 width -0.5 font ",12"
set ylabel formula("A η / ν") offset 1,0
set ytics 0.1
top(p) = 0.988 - 0.2375 * (p - 1)
numbers = '"0.05" 0.05, "0.1" 0.1, "0.2" 0.2, "0.5" 0.5, "1" 1, "2" 2'
bare(numbers) = system(sprintf("printf '%%s' '%s' | sed 's/\"[^\"]*\"/\"\"/g'", numbers))
# The clause that draws one triangle, in the colour of its curve; empty where the table has none.
locking(p, j) = !has(sprintf("locking-%d-%d", p, j)) ? "" : sprintf( \
  ", table index 'locking-%d-%d' using 1:(0.012) with points ls %d pt 11 ps 1.2 notitle", p, j, j)
do for [p=1:4] {
  set tmargin at screen top(p)
  set bmargin at screen top(p) - 0.2175
  eval panel(substr("abcd", p, p), top(p))
  if (p == 4) { set xlabel "amplitude ".formula("A").", divided by ".formula("ε") offset 0,0.3 } else { unset xlabel }
  eval "set xtics (".(p == 4 ? numbers : bare(numbers)).")"
  marks = ""
  do for [j=1:count(p)] { marks = marks.locking(p, j) }
  eval 'plot for [j=1:count(p)] table index sprintf("curve-%d-%d", p, j) using 1:2 with linespoints ls j title symbol(columnheader(2))'.marks
  eval axes("A", "A η / ν", "x")
}
unset multiplot
