# What the figures of one's own scene share; loaded by each. A scene in units has the block "scales", and then the upper
# and the right axis speak in seconds and millimetres. A script says which of its axes are times and which are lengths,
# by `units("x", "time")` and `units("y", "length")`, and after plotting `eval answers(...)` as others say axes().
in_units = has("scales")
scale_time = 1; scale_length = 1
if (in_units) {
  stats table index "scales" using 1 nooutput; scale_time = STATS_max
  stats table index "scales" using 2 nooutput; scale_length = STATS_max
  set tmargin at screen 0.80
  set rmargin at screen 0.885
}
units(axis, what) = !in_units ? "" : sprintf( \
  "set %stics nomirror; set link %s2 via %.17g*%s inverse %s/%.17g; set %s2tics; set m%s2tics; set %s2label '%s' offset %s", \
  axis, axis, scale_of(what), axis, axis, scale_of(what), axis, axis, axis, \
  what eq "time" ? "time in s" : "amplitude in mm", axis eq "x" ? "0,-0.2" : "-0.5,0")
scale_of(what) = what eq "time" ? scale_time : scale_length
# An axis through what a column holds: logarithmic if its numbers span more than a decade, and none is below `least`.
spans(block, column) = sprintf("stats table index '%s' using %d nooutput", block, column)
