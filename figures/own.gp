# What the figures of one's own scene share; loaded by each. A scene in units has the block "scales", and then its axes are
# in seconds, millimetres and hertz, the upper and the right one dimensionless. Each script says what its axes measure,
# between which ends of the table's numbers, and whether by logarithms, by
# `eval axis("x", "time", "time", "t", from, to, 0)`, and plots column 1 as ($1 * unit_x).
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
unit_x = 1; unit_y = 1
set minussign
# Over less than two decades a logarithmic axis is marked at 1, 2 and 5 of each, or it had but a number or two.
marks(name, low, high) = high / low >= 100 ? "" : sprintf("set %stics (%s); ", name, marks_of(floor(log10(low)), log10(high)))
marks_of(decade, end) = sprintf("%g, %g, %g", 10.0 ** decade, 2 * 10.0 ** decade, 5 * 10.0 ** decade).\
  (decade + 1 > end ? "" : ", ".marks_of(decade + 1, end))
scale_of(what) = what eq "time" ? scale_time : what eq "frequency" ? scale_frequency : scale_length
# A prefix for the axis whose largest value is `high`, in seconds, millimetres or hertz.
is_small(what, high) = what ne "frequency" && high < 0.1
is_large(what, high) = what ne "time" && high >= 1e4
unit_of(what, high) = what eq "time" ? (is_small(what, high) ? "ms" : "s") : \
  what eq "frequency" ? (is_large(what, high) ? "kHz" : "Hz") : \
  is_small(what, high) ? "µm" : is_large(what, high) ? "m" : "mm"
factor_of(what, high) = \
  !in_units ? 1 : scale_of(what) * (is_small(what, high * scale_of(what)) ? 1e3 : is_large(what, high * scale_of(what)) ? 1e-3 : 1)
# The axis itself, and beside it the dimensionless one; logarithmic axes cannot be linked. Dimensionless values of the
# table times unit_x or unit_y, which it sets, are the axis's; name_x or name_y is for axes().
axis(name, what, noun, symbol, low, high, is_logarithmic) = \
  first_axis(name, factor_of(what, high), low * factor_of(what, high), high * factor_of(what, high), is_logarithmic).\
  (in_units ? labels(name, what, noun, symbol, unit_of(what, high * scale_of(what))).second_axis(name, low, high, is_logarithmic) \
            : labels(name, what, what eq "time" ? "dimensionless time t" : noun." ".symbol, symbol, ""))
first_axis(name, factor, low, high, is_logarithmic) = \
  sprintf("unit_%s = %.17g; set %srange [%.17g:%.17g]; ", name, factor, name, low, high).\
  (is_logarithmic ? sprintf("set logscale %s; ", name).marks(name, low, high) : "")
labels(name, what, noun, symbol, unit) = \
  sprintf("set %slabel '%s'; name_%s = '%s'; ", name, noun.in_unit(unit), name, strlen(unit) ? noun.in_unit(unit) : symbol).\
  (!strlen(unit) ? "" : sprintf("set %s2label '%s' offset %s; ", name, \
    what eq "time" ? "dimensionless time t" : what eq "frequency" ? "ω, in units of Ω" : symbol.(has("dampers") ? ", in units of ε" : ", in units of the clearance"), \
    name eq "x" ? "0,-0.5" : "-0.8,0"))
in_unit(unit) = strlen(unit) ? " in ".unit : ""
second_axis(name, low, high, is_logarithmic) = \
  sprintf("set %stics nomirror; set %s2tics; set %s2range [%.17g:%.17g]; ", name, name, name, low, high).\
  (is_logarithmic ? sprintf("set logscale %s2; ", name).marks(name."2", low, high) : sprintf("set m%s2tics; ", name)).\
  (name eq "y" ? "set rmargin at screen 0.88" : "")
look(block, column) = sprintf("stats table index '%s' using %d nooutput", block, column)
