#include "application/measured/comparison.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "impact_damper/analysis/ensemble.hpp"
#include "impact_damper/analysis/theory.hpp"
#include "impact_damper/base/number_text.hpp"
#include "impact_damper/io/json_parts.hpp"
#include "impact_damper/io/run_file.hpp"
#include "impact_damper/io/scene_file.hpp"
#include "impact_damper/math/elementary.hpp"

namespace impact_damper {
namespace {

using Layout = JsonWriter::Layout;

// Returns (M12.1) of the rows; amplitudes and times keep their units, `omega` is in radians per unit of time.
LossFactor loss_of(HalfCycles rows, double omega) {
  for (double& each : rows.peak_time) each *= omega;
  LossFactor loss = local_loss_factor(rows, 0, rows.amplitude.size());
  for (double& each : loss.time) each /= omega;
  return loss;
}

SimulatedDecays decays_of(const SceneInUnits& scene, const Engine& engine, const Reduction& reduction,
                          const std::vector<LossBin>& bins, const ComparisonOptions& options) {
  SimulatedDecays result{.scene = scene, .decays = {}, .losses = {}, .bins = {}};
  result.decays.resize(std::size_t(options.releases));
  const double until = std::ranges::min(reduction.amplitude);
  for_each_index(options.releases, options.fit.threads, [&](std::int64_t i) {
    result.decays[std::size_t(i)] =
        simulated_half_cycles(decay_scene(scene, reduction, until, options.fit.seed, i), engine);
  });
  const double time_unit = scales_of(scene).of(Dimension::time), length = *scene.damper().clearance;
  std::vector<std::vector<double>> losses(bins.size());
  for (HalfCycles& rows : result.decays) {
    const std::vector<double> of_bins = log_losses(rows, length, bins);
    for (std::size_t k = 0; k < of_bins.size(); ++k) losses[k].push_back(of_bins[k]);
    for (double& each : rows.peak_time) each *= time_unit;
    for (double& each : rows.amplitude) each *= length;
    // Times begin where the record's first peak would be.
    const double top = logarithm(reduction.amplitude.front());
    std::size_t begin = 1;
    while (begin < rows.amplitude.size() && rows.amplitude[begin] > reduction.amplitude.front()) ++begin;
    if (begin >= rows.amplitude.size()) {
      rows = {};
      result.losses.emplace_back();
      continue;
    }
    const double upper = logarithm(rows.amplitude[begin - 1]), lower = logarithm(rows.amplitude[begin]);
    const double part = upper > lower ? std::clamp((upper - top) / (upper - lower), 0.0, 1.0) : 0;
    const double shift = reduction.time.front() - rows.peak_time[begin - 1] -
                         part * (rows.peak_time[begin] - rows.peak_time[begin - 1]);
    for (double& each : rows.peak_time) each += shift;
    const auto from = std::ptrdiff_t(begin);
    rows.peak_time.erase(rows.peak_time.begin(), rows.peak_time.begin() + from);
    rows.amplitude.erase(rows.amplitude.begin(), rows.amplitude.begin() + from);
    const std::size_t count = rows.peak_time.size();
    result.losses.push_back(count < 3 ? LossFactor{}
                                      : loss_of(rows, half_turn<double>() * double(count - 1) /
                                                          (rows.peak_time.back() - rows.peak_time[0])));
  }
  for (auto& each : losses) {
    if (each.size() < result.decays.size()) break;
    result.bins.push_back(exponential(spread_of(std::move(each)).median));
  }
  return result;
}

// The decay without impacts, from the record's first peak on.
SimulatedDecays decay_without_impacts(const SceneInUnits& scene, double mass_ratio,
                                      const Reduction& reduction, const std::vector<LossBin>& bins) {
  SimulatedDecays result{.scene = scene, .decays = {}, .losses = {}, .bins = {}};
  const double damping_ratio = value_of(scene, FitParameter::damping_ratio) / std::sqrt(1 + mass_ratio);
  if (!(damping_ratio < 1)) return result;
  const double part = std::sqrt(1 - damping_ratio * damping_ratio),
               omega = 2 * half_turn<double>() * scales_of(scene).of(Dimension::frequency) * part /
                       std::sqrt(1 + mass_ratio),
               loss = 2 * damping_ratio / part;
  HalfCycles rows;
  const double half_cycle = half_turn<double>() / omega;
  const auto count = std::int64_t((reduction.time.back() - reduction.time.front()) / half_cycle);
  for (std::int64_t i = 0; i <= count; ++i) {
    const double t = double(i) * half_cycle;
    rows.peak_time.push_back(reduction.time.front() + t);
    rows.amplitude.push_back(reduction.amplitude.front() * exponential(-loss / 2 * omega * t));
  }
  result.bins.assign(bins.size(), loss);
  result.losses.push_back(rows.amplitude.size() < 3 ? LossFactor{} : loss_of(rows, omega));
  result.decays.push_back(std::move(rows));
  return result;
}

std::string text_of(double value) { return rounded_text(value, 3); }

void remark_on_what_is_left_out(Comparison& c) {
  const std::int64_t left_out = c.reduction.clipped + c.reduction.unclear;
  if (left_out <= std::int64_t(c.reduction.time.size())) return;
  c.remarks.push_back(
      filled("More half cycles are left out, {}, than are used: what disturbs the record, such as impacts "
             "that ring in an accelerometer, must be filtered out of it first.",
             left_out));
}

// Returns whether the record oscillates as the scene does.
bool remark_on_frequency(Comparison& c) {
  constexpr double tolerance = 0.02;
  const double f = c.reduction.frequency;
  if (f >= c.lowest_frequency * (1 - tolerance) && f <= c.highest_frequency * (1 + tolerance)) return true;
  const double nearest = f < c.lowest_frequency ? c.lowest_frequency : c.highest_frequency;
  c.remarks.push_back(filled(
      "The record oscillates at {} Hz, {} times what the scene does: its sampling rate is wrong, or the "
      "scene's mass or stiffness. Loss factors are per radian of the record's own oscillation, so a wrong "
      "sampling rate does not change them{}.",
      text_of(f), text_of(f / nearest),
      c.record.quantity != MeasuredQuantity::displacement
          ? filled(", but it changes the displacements that are made of this {}: nothing is fitted",
                   name_of(c.record.quantity))
          : ""));
  return false;
}

void remark_on_fit(Comparison& c) {
  const DecayFit& fit = *c.fit;
  if (fit.normal_deviate > most_normal_deviate && c.without_impacts)
    c.remarks.push_back(filled(
        "The loss factor is not the same at all amplitudes, as it would be with viscous damping alone: "
        "chi square is {} with {} degrees of freedom. The interval means nothing.",
        text_of(fit.chi_square), fit.degrees));
  else if (fit.normal_deviate > most_normal_deviate)
    c.remarks.push_back(
        filled("No decay in the searched range is like the record: chi square is {} with {} "
               "degrees of freedom. The intervals mean nothing.",
               text_of(fit.chi_square), fit.degrees));
  for (const FittedParameter& each : fit.parameters) {
    const std::string_view name = name_of(each.parameter);
    const auto [least, most] = std::minmax(each.searched_from, each.searched_to);
    if (each.open_below && each.open_above && each.low <= least && each.high >= most) {
      c.remarks.push_back(
          filled("The record does not tell {}: the whole searched range agrees with it.", name));
      continue;
    }
    const auto remark = [&](double end, std::string_view side) {
      c.remarks.push_back(filled("The interval of {} ends where the search did, at {}: it may be longer {}.",
                                 name, with_unit(text_of(end), unit_of(each.parameter)), side));
    };
    if (each.open_below && !(is_bounded_by_0(each.parameter) && each.low <= least)) remark(each.low, "below");
    if (each.open_above) remark(each.high, "above");
  }
  constexpr double strong = 0.9;
  for (std::size_t j = 0; j < fit.parameters.size(); ++j) {
    for (std::size_t k = 0; k < j; ++k) {
      if (std::abs(fit.correlation[j][k]) < strong) continue;
      c.remarks.push_back(filled(
          "{} and {} can hardly be distinguished: their correlation, in ln(1 - e) and logarithms, is {}.",
          name_of(fit.parameters[k].parameter), name_of(fit.parameters[j].parameter),
          text_of(fit.correlation[j][k])));
    }
  }
}

// Returns the amplitude, mm, up to which friction and weight hold the secondary mass (M15.14); 0 without
// them.
double locking_amplitude_of(const SceneInUnits& scene) {
  const Scene made = dimensionless(scene);
  return locking_amplitude(1 / std::sqrt(1 + made.damper().mass_ratio),
                           made.damper().holding() + made.weight) *
         *scene.damper().clearance;
}

void remark_on_range(Comparison& c) {
  const SceneInUnits& scene = c.fitted ? c.fitted->scene : c.given.scene;
  const double fold = fold_amplitude(value_of(scene, FitParameter::restitution)) * *scene.damper().clearance;
  const double cease = std::max(fold, locking_amplitude_of(scene));
  if (c.reduction.amplitude.back() > cease)
    c.remarks.push_back(
        filled("The record ends at {} mm, above the {} mm where impacts cease: from there "
               "restitution and clearance could be distinguished.",
               text_of(c.reduction.amplitude.back()), text_of(cease)));
}

// Says what friction, inclination and drag count as known, and up to which amplitude they hold the mass.
void remark_on_components(Comparison& c, const FitOptions& options) {
  const SceneInUnits& scene = c.fitted ? c.fitted->scene : c.given.scene;
  const DamperInUnits& damper = scene.damper();
  const auto is_given = [](const std::optional<double>& number) { return number.value_or(0) > 0; };
  std::vector<std::string> known;
  const auto note = [&](std::string_view what, const std::optional<double>& number, std::string_view unit) {
    if (is_given(number)) known.push_back(filled("{} of {}", what, with_unit(text_of(*number), unit)));
  };
  if (std::ranges::find(options.parameters, FitParameter::friction_coefficient) == options.parameters.end())
    note("a coefficient of friction", damper.friction_coefficient, "");
  note("one of static friction", damper.static_friction_coefficient, "");
  note("an inclination", scene.inclination, "degrees");
  note("a drag", damper.drag, unit_of(Dimension::damping, true));
  std::string remark;
  if (!known.empty())
    remark = filled("Taken as known from the scene: {}. If it is wrong, so are the simulations.",
                    listed(std::vector<std::string_view>(known.begin(), known.end()), "and"));
  if (const double held = locking_amplitude_of(scene); held > 0)
    remark += filled("{}Up to {} mm the secondary mass is held at rest in its cavity.",
                     remark.empty() ? "" : " ", text_of(held));
  if (!remark.empty()) c.remarks.push_back(remark);
}

void write_decays(JsonWriter& out, std::string_view name, const SimulatedDecays& decays) {
  out.open_object(name, Layout::lines);
  out.open_object("scene", Layout::one_line);
  write_unit_fields(out, decays.scene);
  out.close();
  out.objects("decays", Layout::lines, decays.decays, [&](const HalfCycles& each) {
    out.fields("time", each.peak_time, "amplitude", each.amplitude);
  });
  out.close();
}

}  // namespace

Comparison compared(const std::string& record_name, const MeasuredRecord& record,
                    const std::string& scene_name, const SceneInUnits& scene, const Engine& engine,
                    const ComparisonOptions& options, const std::function<void(const std::string&)>& tell) {
  std::vector<Problem> problems = problems_of_fit(scene, options.fit);
  if (options.releases < 1)
    problems.push_back({"releases", "must be >= 1, got " + std::to_string(options.releases)});
  require_none(problems);
  Comparison c;
  c.record_name = record_name, c.scene_name = scene_name, c.record = record, c.engine = engine;
  c.without_impacts = options.without_impacts;
  c.highest_frequency = scales_of(scene).of(Dimension::frequency);
  c.reduction = reduced(record_name, record, c.highest_frequency);
  HalfCycles rows;
  rows.peak_time = c.reduction.time, rows.amplitude = c.reduction.amplitude;
  c.loss = loss_of(std::move(rows), 2 * half_turn<double>() * c.reduction.frequency);
  c.bins = loss_bins(c.reduction);
  const double carried = locked_mass_ratio(scene, options.without_impacts.value_or(WithoutImpacts::locked));
  c.lowest_frequency = c.highest_frequency / std::sqrt(1 + carried);
  if (options.without_impacts) c.highest_frequency = c.lowest_frequency;
  c.remarks = c.reduction.outside;
  const auto decays = [&](const SceneInUnits& of) {
    return c.without_impacts ? decay_without_impacts(of, carried, c.reduction, c.bins)
                             : decays_of(of, engine, c.reduction, c.bins, options);
  };
  tell("simulating the scene");
  c.given = decays(scene);
  const bool can_fit = remark_on_frequency(c) || record.quantity == MeasuredQuantity::displacement;
  if (can_fit && !options.fit.parameters.empty()) {
    FitResult result = c.without_impacts ? fit_without_impacts(carried, c.bins)
                                         : fit_decay(scene, engine, c.reduction, c.bins, options.fit, tell);
    c.fit = std::move(result.fit);
    if (!c.fit) c.remarks.push_back("Nothing is fitted: " + result.problem + ".");
  }
  if (c.fit) {
    SceneInUnits best = scene;
    for (const FittedParameter& each : c.fit->parameters) set_value(best, each.parameter, each.best);
    c.fitted = decays(best);
    remark_on_fit(c);
  }
  remark_on_what_is_left_out(c);
  if (c.without_impacts) return c;
  remark_on_range(c);
  remark_on_components(c, options.fit);
  if (record.quantity == MeasuredQuantity::acceleration)
    c.remarks.push_back(
        filled("The acceleration is integrated twice: impacts count by their area. Where the record lacks "
               "them, because they lie between samples or beyond the sensor's range, amplitudes may err by "
               "{} % (the mass ratio){}.",
               text_of(100 * dimensionless(scene).damper().mass_ratio),
               c.fit ? ", for which the intervals do not allow" : ""));
  return c;
}

std::string comparison_text(const Comparison& c) {
  JsonWriter out("comparison");
  out.open_object(Layout::lines);
  out.field("schema", std::string_view("impact-damper/comparison/1"));
  const Reduction& r = c.reduction;
  out.object("record", Layout::one_line, "file", c.record_name, "quantity", name_of(c.record.quantity),
             "read_as", c.record.read_as, "samples", r.samples, "empty_cells", c.record.empty_cells,
             "duration", r.duration, "sampling_rate", r.sampling_rate);
  if (c.without_impacts) out.field("without_impacts", name_of(*c.without_impacts));
  out.object("reduction", Layout::one_line, "frequency", r.frequency, "noise", r.noise, "offset", r.offset,
             "drift", r.drift, "clipped", r.clipped, "in_gaps", r.in_gaps, "unclear", r.unclear,
             "ends_in_noise", r.ends_in_noise);
  out.object("half_cycles", Layout::lines, "number", r.half_cycle, "time", r.time, "amplitude", r.amplitude,
             "error", r.error);
  out.object("loss_factor", Layout::lines, "amplitude", c.loss.amplitude, "time", c.loss.time, "eta",
             c.loss.eta);
  out.objects("bins", Layout::lines, c.bins, [&](const LossBin& bin) {
    const auto k = std::size_t(&bin - c.bins.data());
    std::optional<double> given, fitted, scatter;
    if (k < c.given.bins.size()) given = c.given.bins[k];
    if (c.fit) fitted = c.fit->loss[k], scatter = c.fit->scatter[k];
    out.fields("upper", bin.upper, "lower", bin.lower, "half_cycles", bin.half_cycles, "eta", bin.loss,
               "relative_error", bin.error, "simulated", given, "fitted", fitted, "relative_scatter",
               scatter);
  });
  out.object("scene_frequency", Layout::one_line, "lowest", c.lowest_frequency, "highest",
             c.highest_frequency);
  write_engine(out, c.engine);
  write_decays(out, "simulated", c.given);
  if (c.fit) {
    out.open_object("fit", Layout::lines);
    const std::vector<FittedParameter>& parameters = c.fit->parameters;
    out.objects("parameters", Layout::lines, parameters, [&](const FittedParameter& each) {
      out.fields("name", name_of(each.parameter), "unit", unit_of(each.parameter), "best", each.best, "low",
                 each.low, "high", each.high, "searched_from", each.searched_from, "searched_to",
                 each.searched_to, "open_below", each.open_below, "open_above", each.open_above);
    });
    out.objects("correlation", Layout::lines, parameters, [&](const FittedParameter& each) {
      out.fields("name", name_of(each.parameter), "with",
                 c.fit->correlation[std::size_t(&each - parameters.data())]);
    });
    out.fields("chi_square", c.fit->chi_square, "degrees_of_freedom", c.fit->degrees, "normal_deviate",
               c.fit->normal_deviate, "runs", c.fit->runs);
    out.close();
    write_decays(out, "fitted", *c.fitted);
  }
  out.field("remarks", c.remarks);
  write_provenance(out);
  return sealed(out.finish());
}

}  // namespace impact_damper
