# Above what the paper draws. Below the same four curves with 2 zeta/(1 + nu) taken off (docs/mathematics.md, M11.3),
# on the same scale.
from = 0.03
styles = "1 2 3 4"
theory = "1"
logarithmic = "x"
eval canvas(720, 860)
set lmargin at screen 0.115
set rmargin at screen 0.975
panels = 2
eval captioned
set multiplot
eval panel("a", 0.975)
set tmargin at screen 0.975
set bmargin at screen 0.580
set yrange [0:0.55]
set key bottom right maxrows 4
ordinate = "A (η − 2ζ) / ν"
set ylabel formula(ordinate)
load folder."/loss.gp"

do for [i=1:words(styles)] { eval require(sprintf("second-%d", i), 10) }
eval panel("b", 0.480)
set tmargin at screen 0.480
set bmargin at screen 0.090
ordinate = "A (η − 2ζ / (1 + ν)) / ν"
set ylabel formula(ordinate)
unset key
plot for [i=1:words(styles)] table index sprintf("second-%d", i) using 1:2 with lines ls style_of(i), \
     for [i=1:words(styles)] last = 999 table index sprintf("second-%d", i) \
       using 1:(b = bin($1, i), b < last ? (last = b, $2) : NaN) with points ls style_of(i)
eval axes("A", ordinate, logarithmic)
unset multiplot
