# Somebody's ~/.gnuplot: whatever of this reached a figure would change or spoil it.
set terminal dumb
set decimalsign ","
set samples 7
set logscale xy
set xrange [3:4]
set style data boxes
set style line 1 lc rgb "red" lw 9
set grid
set key left bottom
set datafile separator ";"
set datafile commentschars "0"
set encoding iso_8859_1
set tmargin 20
print "good morning"
