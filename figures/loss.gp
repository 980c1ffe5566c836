# Figures 8-14: curves of the averaged loss factor, the closed forms thinly beside them. The figure's script
# sets axes, key, `styles` (the line style of each curve) and `theory` (which of the curves have closed forms drawn).
do for [i=1:words(styles)] { eval require(sprintf("curve-%d", i), 10) }
do for [i in theory] { eval require("one-impact-".i, 10) }
bounced = ""
do for [i in theory] { if (has("bounce-down-".i)) { bounced = bounced." ".i } }

set xlabel "peak amplitude A"
set logscale x
set xrange [0.03:7]
set xtics ("0.03" 0.03, "0.1" 0.1, "0.3" 0.3, "1" 1, "3" 3, "6" 6)
set mxtics default
set xtics add ("" 0.04 1, "" 0.05 1, "" 0.06 1, "" 0.07 1, "" 0.08 1, "" 0.09 1, "" 0.2 1, "" 0.4 1, \
  "" 0.5 1, "" 0.6 1, "" 0.7 1, "" 0.8 1, "" 0.9 1, "" 2 1, "" 4 1, "" 5 1)

# One mark in each eighth of a decade, or they crowd where a half cycle loses little; staggered from curve to
# curve. The legend's sample is drawn from points outside the axes.
bin(a, i) = floor(8 * log10(a) + i / 4.0)
plot for [i=1:words(styles)] table index sprintf("curve-%d", i) using 1:2 \
       with lines ls (word(styles, i) + 0) notitle, \
     for [i=1:words(styles)] last = 999 table index sprintf("curve-%d", i) \
       using 1:(b = bin($1, i), b < last ? (last = b, $2) : NaN) \
       with points ls (word(styles, i) + 0) notitle, \
     for [i=1:words(styles)] table index sprintf("curve-%d", i) using (1e-9):2 \
       with linespoints ls (word(styles, i) + 0) title columnheader(2), \
     for [i in theory] table index "one-impact-".i using 1:2 with lines ls 9 \
       title (i eq word(theory, 1) ? "closed form, ν → 0" : ""), \
     for [i in bounced] table index "bounce-down-".i using 1:2 with lines ls 9 notitle
