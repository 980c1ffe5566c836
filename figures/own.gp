# What the figures of one's own scene share; loaded by each. A scene in units has the block "scales", and then the upper
# and the right axis speak in seconds and millimetres: each script says what its axes measure, between which ends, and
# whether by logarithms, by `eval axis("x", "time", from, to, 0)`.
in_units = has("scales")
scale_time = 1; scale_length = 1; scale_frequency = 1
if (in_units) {
  stats table index "scales" using 1 nooutput; scale_time = STATS_max
  stats table index "scales" using 2 nooutput; scale_length = STATS_max
  stats table index "scales" using 3 nooutput; scale_frequency = STATS_max
  eval canvas(720, 540)
  set tmargin at screen 0.795
}
# A narrow axis is not worth logarithms.
is_wide(low, high) = high > 3 * low
# Over less than two decades a logarithmic axis is marked at 1, 2 and 5 of each, or it had but a number or two.
marks(name, low, high) = high / low >= 100 ? "" : sprintf("set %stics (%s); ", name, marks_of(floor(log10(low)), log10(high)))
marks_of(decade, end) = sprintf("%g, %g, %g", 10.0 ** decade, 2 * 10.0 ** decade, 5 * 10.0 ** decade).\
  (decade + 1 > end ? "" : ", ".marks_of(decade + 1, end))
scale_of(what) = what eq "time" ? scale_time : what eq "frequency" ? scale_frequency : scale_length
# The axis itself, and beside it the one in units; logarithmic axes cannot be linked.
axis(name, what, low, high, is_logarithmic) = \
  sprintf("set %srange [%.17g:%.17g]; ", name, low, high).\
  (is_logarithmic ? sprintf("set logscale %s; ", name).marks(name, low, high) : "").\
  (in_units ? second_axis(name, what, low * scale_of(what), high * scale_of(what), is_logarithmic) : "")
second_axis(name, what, low, high, is_logarithmic) = \
  sprintf("set %stics nomirror; set %s2tics; set %s2range [%.17g:%.17g]; ", name, name, name, low, high).\
  (is_logarithmic ? sprintf("set logscale %s2; ", name).marks(name."2", low, high) : sprintf("set m%s2tics; ", name)).\
  sprintf("set %s2label '%s' offset %s; ", name, what eq "time" ? "time in s" : what eq "frequency" ? "frequency in Hz" : "amplitude in mm", \
          name eq "x" ? "0,-0.5" : "-0.8,0").\
  (name eq "y" ? "set rmargin at screen 0.88" : "")
look(block, column) = sprintf("stats table index '%s' using %d nooutput", block, column)
