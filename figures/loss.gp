# Figures 8-14: curves of the averaged loss factor, the closed forms thinly beside them. The figure's script
# sets `from` (of the amplitude axis), `ordinate` and its axis, and which axes are `logarithmic`; it may set `styles` (the
# line style of each curve) and `theory` (the curves whose closed forms are drawn), which otherwise are all in the table.
curves = system(sprintf("grep -c -x '# curve-[0-9]*' '%s' || true", table)) + 0
if (!exists("styles")) { styles = ""; do for [i=1:curves] { styles = sprintf("%s %d", styles, 1 + (i - 1) % 4) } }
if (!exists("theory")) { theory = ""; do for [i=1:words(styles)] { theory = sprintf("%s %d", theory, i) } }
do for [i=1:words(styles)] { eval require(sprintf("curve-%d", i), 10) }
do for [i in theory] { eval require("one-impact-".i, 10) }
bounced = ""
do for [i in theory] { if (has("bounce-down-".i)) { bounced = bounced." ".i } }
failed = ""
do for [i=1:words(styles)] { if (has(sprintf("failed-%d", i))) { failed = sprintf("%s %d", failed, i) } }

if (!exists("panels")) { eval captioned }
set xlabel "peak amplitude ".formula("A")
eval 'set logscale '.logarithmic
set xrange [from:7]
set xtics ("0.01" 0.01, "0.03" 0.03, "0.1" 0.1, "0.3" 0.3, "1" 1, "3" 3, "6" 6)
do for [decade in "0.01 0.1 1"] {
  do for [k=2:9] { if (k != 3 && k * decade < 6) { set xtics add ("" k * decade 1) } }
}

# One mark in each eighth of a decade, or they crowd where a half cycle loses little; staggered from curve to
# curve. The legend's sample is drawn from points outside the axes.
bin(a, i) = floor(8 * log10(a) + i / 4.0)
style_of(i) = word(styles, i) + 0
# A loop over nothing would still be entered once, so clauses that may be empty are put in as text.
spread = !has("spread") ? "" : \
  'table index "spread" using 1:2:3 with filledcurves lc rgb pale notitle,'.\
  'table index "spread" using 1:4 with lines ls 10 dt (6,4) title columnheader(4),'
band = ""
do for [i=1:words(styles)] { if (has(sprintf("band-%d", i))) { band = band.sprintf( \
  'table index "band-%d" using 1:2:3 with filledcurves lc rgb sky title columnheader(3),', i) } }
behind_failure = !words(failed) ? "" : \
  ', for [i in failed] table index "failed-".i using 1:2 with points ls style_of(i + 0) pt 7 ps 0.15 notitle'.\
  ', keyentry with points pt 7 ps 0.3 lc rgb black title "after impact failure"'
bounce_down = !words(bounced) ? "" : \
  ', for [i in bounced] table index "bounce-down-".i using 1:2 with lines ls 9 notitle'
eval 'plot '.spread.band.\
  'for [i=1:words(styles)] table index sprintf("curve-%d", i) using 1:2 with lines ls style_of(i) notitle,'.\
  'for [i=1:words(styles)] last = 999 table index sprintf("curve-%d", i)'.\
  '  using 1:(b = bin($1, i), b < last ? (last = b, $2) : NaN) with points ls style_of(i) notitle,'.\
  'for [i=1:words(styles)] table index sprintf("curve-%d", i) using (1e-9):2'.\
  '  with linespoints ls style_of(i) title legend(columnheader(2)),'.\
  'for [i in theory] table index "one-impact-".i using 1:2 with lines ls 9'.\
  '  title (i eq word(theory, 1) ? "closed forms, ".formula("ν")." → 0" : "")'.bounce_down.behind_failure
eval axes("A", ordinate, logarithmic)
