# What all figures share; read before the figure's own script (see draw), which finds these variables:
# table, output, title, parameters, folder.
set encoding utf8
canvas(width, height) = sprintf( \
  'set terminal svg size %d,%d enhanced font "DejaVu Sans,15" linewidth 1 rounded background "white"', \
  width, height)
eval canvas(720, 500)
set output output

# The colours of Okabe and Ito, told apart by all; every line also differs in dash and mark, so that a black
# and white copy reads as well. Line type 1 is the base scene in every figure it appears in.
black = "#000000"; blue = "#0072B2"; vermillion = "#D55E00"; green = "#009E73"; purple = "#CC79A7"
orange = "#E69F00"; grey = "#6E6E6E"; pale = "#EAEAEA"; sky = "#A6D8F5"
set style line 1 lc rgb black      lw 1.8 dt 1           pt 7 ps 0.5
set style line 2 lc rgb blue       lw 1.8 dt (9,3)       pt 4 ps 0.6
set style line 3 lc rgb vermillion lw 1.8 dt (9,3,2,3)   pt 8 ps 0.7
set style line 4 lc rgb green      lw 1.8 dt (3,2.5)     pt 6 ps 0.6
# Theory: thin, without marks.
set style line 9 lc rgb purple     lw 1.3 dt 1
set style line 10 lc rgb grey      lw 0.8 dt 1

set border 31 lw 1
set tics in scale 0.8,0.4 font ",13"
set key noopaque samplen 3.2 spacing 1.15 font ",13" width -1
set title title.(strlen(parameters) ? "\n{/*0.82 ".parameters."}" : "") font ",15" offset 0,-0.4
set tmargin at screen 0.875
# The paper's figures have their titles and parameters in their captions.
captioned = "unset title; set tmargin at screen 0.965"

# Symbols are set in italics: letters of a formula; in a legend the one before " = ".
formula(s) = !strlen(s) ? "" : \
  (strstrt("ABCDFKMTXYZdefmtwxyzεζηνω", s[1:1]) ? "{/:Italic ".s[1:1]."}" : s[1:1]).formula(s[2:strlen(s)])
legend(s) = s[2:4] eq " = " ? formula(s[1:1]).s[2:strlen(s)] : s[3:5] eq " = " ? formula(s[1:1]).s[2:strlen(s)] : s
# The letter of a panel, left of its upper end.
panel(letter, top) = sprintf("set label 90 '(%s)' at screen 0.006,screen %g left font ',15'", letter, top - 0.012)

# Nothing is drawn that is not there: the block must hold `least` rows, all of them numbers.
# One column at a time: for two, gnuplot also fits a line and complains about short blocks.
require(block, least) = sprintf( \
  "if (!has('%s')) { printerr 'block %s is not in the table'; exit status 1 };".\
  "do for [c=1:2] { stats table index '%s' using c nooutput;".\
  " if (STATS_records < %d || STATS_invalid > 0) { printerr 'block %s is short or not finite'; exit status 1 } }", \
  block, block, block, least, block)
# Whether an optional block is there.
has(block) = system(sprintf("grep -c -x '# %s' '%s' || true", block, table)) > 0

# For whoever reads values off the picture (see draw): a line of JSON says what the axes just plotted measure, the
# values at their ends, where those lie in the SVG (from its left, from its bottom), and which of x and y are logarithmic.
# A script says `eval axes("A", "η", "xy")` after each plot.
axes(x, y, logarithmic) = sprintf( \
  "print sprintf('{\"x\": [\"%s\", %%.10g, %%.10g, %%g, %%g], \"y\": [\"%s\", %%.10g, %%.10g, %%g, %%g], \"log\": \"%s\"}', ".\
  "GPVAL_X_MIN, GPVAL_X_MAX, GPVAL_TERM_XMIN, GPVAL_TERM_XMAX, ".\
  "GPVAL_Y_MIN, GPVAL_Y_MAX, GPVAL_TERM_YMIN, GPVAL_TERM_YMAX)", x, y, logarithmic)
