#include "application/sweeps/kept_quantities.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "impact_damper/analysis/design.hpp"
#include "impact_damper/analysis/loss_factor.hpp"
#include "impact_damper/analysis/regimes.hpp"
#include "impact_damper/base/number_text.hpp"
#include "impact_damper/base/text.hpp"
#include "impact_damper/motion/wall.hpp"
#include "impact_damper/orbits/lyapunov.hpp"
#include "impact_damper/simulate.hpp"
#include "impact_damper/steady/sweep.hpp"

namespace impact_damper {

// Makes each experiment once, when the first quantity asks for it.
class RunFindings {
 public:
  RunFindings(const Scene& given_scene, const Engine& given_engine, const ForcedRules& rules,
              const std::optional<Scales>& scales, const Record& record)
      : scene(given_scene), engine(given_engine), rules_(rules), scales_(scales), record_(record) {}

  const Run& run() {
    if (!run_) {
      run_ = simulate(scene, engine, record_);
      const StopReason reason = run_->stop_reason;
      if (reason != StopReason::time && reason != StopReason::amplitude) note_end(reason);
    }
    return *run_;
  }
  // Over the amplitude; empty under a force, which keeps the motion up.
  const LossFactor& loss() {
    if (!loss_) loss_ = scene.force_amplitude == 0 ? loss_before_failure(run()) : LossFactor{};
    return *loss_;
  }
  // The largest loss factor and its amplitude, if it is > 0.
  struct Peak {
    double amplitude = 0, loss = 0;
  };
  std::optional<Peak> largest_loss() {
    const auto best = std::ranges::max_element(loss().eta);
    // Without losses energy only goes to and fro.
    const auto keeps_speed = [](const auto& damper) { return damper.restitution == 1; };
    const bool is_lossless = scene.damping_ratio == 0 && std::ranges::all_of(scene.dampers, keeps_speed);
    if (is_lossless || best == loss().eta.end() || !(*best > 0)) return std::nullopt;
    return Peak{loss().amplitude[static_cast<std::size_t>(best - loss().eta.begin())], *best};
  }
  // Absent where a budget ended it, or where it is still growing or decaying.
  const std::optional<SteadyState>& steady() {
    if (!steady_) {
      steady_.emplace(ForcedScene(scene, engine).settle(release_of(scene), rules_.steady));
      if (!note_whether_steady(**steady_)) steady_->reset();
    }
    return *steady_;
  }
  struct Worst {
    double frequency = 0, amplitude = 0;
  };
  const std::optional<Worst>& worst() {
    if (!worst_) worst_.emplace(found_worst());
    return *worst_;
  }
  const LyapunovExponents& exponents() {
    if (!exponents_) {
      exponents_ = lyapunov_exponents(scene, engine, rules_.lyapunov_periods, rules_.lyapunov_discard);
      if (exponents_->stop_reason != StopReason::time) note_end(exponents_->stop_reason);
    }
    return *exponents_;
  }
  std::string_view end() const { return end_; }

  const Scene& scene;
  const Engine& engine;

 private:
  void note_end(StopReason reason) { note_end(name_of(reason)); }
  void note_end(std::string_view end) {
    if (end_ == "done") end_ = end;
  }
  bool note_whether_steady(const SteadyState& state) {
    if (state.stop_reason != StopReason::time) note_end(state.stop_reason);
    const bool is_steady = state.means && (state.period || is_balanced(state) == true);
    if (state.means && !is_steady) note_end("not_steady");
    return is_steady;
  }
  std::optional<Worst> found_worst() {
    const FrequencyRange range = rules_.frequencies.value_or(FrequencyRange{});
    const double unit = scale_of(Dimension::frequency, scales_);
    const Axis axis{&Scene::force_frequency, range.from / unit, range.to / unit, range.count};
    const auto sweeps =
        sweep(scene, engine, axis, rules_.steady, {release_of(scene)}, Threads{1}, [](std::int64_t) {});
    std::optional<Worst> worst;
    bool all_steady = true;
    for (const auto* way : {&sweeps[0].up, &sweeps[0].down}) {
      for (std::size_t i = 0; i < way->size(); ++i) {
        const SteadyState& state = (*way)[i];
        if (!note_whether_steady(state)) {
          all_steady = false;
        } else if (!(worst && state.means->amplitude <= worst->amplitude)) {
          worst = {axis.value(std::int64_t(i)), state.means->amplitude};
        }
      }
    }
    return all_steady ? worst : std::nullopt;  // the one that is not may be the worst
  }

  const ForcedRules& rules_;
  const std::optional<Scales>& scales_;
  const Record& record_;
  std::optional<Run> run_;
  std::optional<LossFactor> loss_;
  std::optional<std::optional<SteadyState>> steady_;  // absent as long as nothing asked for it, as the next
  std::optional<std::optional<Worst>> worst_;
  std::optional<LyapunovExponents> exponents_;
  std::string_view end_ = "done";
};

namespace {

using Number = std::optional<double>;

// Returns one of the numbers that find() returns together, if it returns any.
template <auto find, auto number>
Number one_of(RunFindings& found, double) {
  const auto& all = (found.*find)();
  return all ? Number(std::invoke(number, *all)) : std::nullopt;
}

// (M15.5).
Number loss_factor_at(RunFindings& found, double amplitude) {
  const LossFactor& loss = found.loss();
  const auto below = std::ranges::find_if(loss.amplitude, [&](double a) { return a < amplitude; });
  if (below == loss.amplitude.begin() || below == loss.amplitude.end()) return std::nullopt;
  const auto i = static_cast<std::size_t>(below - loss.amplitude.begin());
  const double part = (amplitude - loss.amplitude[i]) / (loss.amplitude[i - 1] - loss.amplitude[i]);
  return loss.eta[i] + (loss.eta[i - 1] - loss.eta[i]) * part;
}

// Among the amplitudes whose loss factor is above the bound.
template <class Better>
Number extreme_amplitude(RunFindings& found, double bound) {
  const LossFactor& loss = found.loss();
  Number extreme;
  for (std::size_t i = 0; i < loss.eta.size(); ++i)
    if (loss.eta[i] > bound && !(extreme && !Better()(loss.amplitude[i], *extreme)))
      extreme = loss.amplitude[i];
  return extreme;
}

Number impacts(RunFindings& found, double) {
  std::int64_t all = 0;  // recording each of them would take a twentieth of the run's time
  for (const std::int64_t each : found.run().half_cycles->impacts) all += each;
  return double(all);
}

Number largest_impact_speed(RunFindings& found, double) {
  double largest = 0;
  for (const double velocity : found.run().impacts->relative_velocity)
    largest = std::max(largest, std::abs(velocity));
  return largest;
}

// Of `damper`, whose impacts have number i if there are several.
Number largest_wall_force(RunFindings& found, const SceneDamper& damper, std::size_t i) {
  if (has_rigid_walls(found.engine) || damper.wall.law != WallForm::linear ||
      nominal_contact_time(damper) > longest_short_contact)
    return std::nullopt;
  const Calibration calibration = calibration_of(found.engine);
  const Impacts& impacts = *found.run().impacts;
  double speed = 0;
  for (std::size_t n = 0; n < impacts.time.size(); ++n)
    if (impacts.damper[n] == std::int32_t(i)) speed = std::max(speed, std::abs(impacts.relative_velocity[n]));
  return std::max(short_contact(damper, calibration, speed).force, initial_wall_force(damper, calibration));
}
Number largest_wall_force(RunFindings& found, double) {
  Number largest;
  for (std::size_t i = 0; i < found.scene.dampers.size(); ++i) {
    const Number force = largest_wall_force(found, found.scene.dampers[i], i);
    if (!force) return std::nullopt;
    largest = std::max(largest.value_or(0), *force);
  }
  return largest;
}

Number impact_energy_share(RunFindings& found, double) {
  const EnergyBalance& balance = *found.run().energy;
  double impacts = balance.contact_loss + balance.bounce_down_loss;
  for (const double loss : balance.impact_loss) impacts += loss;
  const double all = impacts + balance.viscous_work;
  if (!(all > 0)) return std::nullopt;
  return impacts / all;
}

using enum Dimension;
using enum Better;
constexpr std::array<Quantity, 17> quantities{{
    {.name = "time_to_amplitude",
     .dimension = time,
     .meaning = "when the amplitude is first below A: that half cycle's peak; of a motion that creeps, the "
                "last |x| = A",
     .at = length,
     .better = least,
     .value = [](RunFindings& found, double amplitude) { return time_below(found.run(), amplitude); }},
    {.name = "loss_factor_at",
     .dimension = ratio,
     .meaning = "loss factor where its curve over the amplitude first passes A; free motion",
     .at = length,
     .better = greatest,
     .value = loss_factor_at},
    {.name = "largest_loss_factor",
     .dimension = ratio,
     .meaning = "largest loss factor before impact failure; free motion",
     .better = greatest,
     .value = one_of<&RunFindings::largest_loss, &RunFindings::Peak::loss>},
    {.name = "amplitude_of_largest_loss_factor",
     .dimension = length,
     .meaning = "the amplitude at which it is met",
     .value = one_of<&RunFindings::largest_loss, &RunFindings::Peak::amplitude>},
    {.name = "lowest_amplitude_above_loss",
     .dimension = length,
     .meaning = "lowest amplitude with a loss factor above L, before impact failure; free motion",
     .at = ratio,
     .better = least,
     .value = extreme_amplitude<std::less<>>},
    {.name = "highest_amplitude_above_loss",
     .dimension = length,
     .meaning = "highest amplitude with a loss factor above L; free motion",
     .at = ratio,
     .better = greatest,
     .value = extreme_amplitude<std::greater<>>},
    {.name = "impacts",
     .dimension = count,
     .meaning = "impacts until the last half cycle that is complete",
     .better = least,
     .value = impacts},
    {.name = "largest_impact_speed",
     .dimension = velocity,
     .meaning = "largest relative speed of an impact; 0 without one",
     .better = least,
     .of_impacts = true,
     .value = largest_impact_speed},
    {.name = "largest_wall_force",
     .dimension = force,
     .meaning =
         "largest force of a wall: of the fastest impact by (M12.4), or at the release; compliant walls with "
         "short contacts",
     .better = least,
     .of_impacts = true,
     .value = largest_wall_force},
    {.name = "impact_energy_share",
     .dimension = ratio,
     .meaning =
         "energy lost in impacts and contacts, divided by all that is lost; a run takes seven times as long",
     .better = greatest,
     .of_energy = true,
     .value = impact_energy_share},
    {.name = "steady_amplitude",
     .dimension = length,
     .meaning = "largest |x| of the steady motion that the release leads to",
     .experiment = Experiment::steady,
     .better = least,
     .value =
         one_of<&RunFindings::steady, [](const SteadyState& steady) { return steady.means->amplitude; }>},
    {.name = "steady_period",
     .dimension = count,
     .meaning = "its period in periods of the force; none if it is not periodic",
     .experiment = Experiment::steady,
     .value = one_of<&RunFindings::steady, &SteadyState::period>},
    {.name = "transient_periods",
     .dimension = count,
     .meaning = "periods of the force from the release until that is known; none if it is not periodic",
     .experiment = Experiment::steady,
     .better = least,
     .value = one_of<&RunFindings::steady,
                     [](const SteadyState& steady) {
                       return steady.period ? Number(steady.transient_periods) : std::nullopt;
                     }>},
    {.name = "impacts_per_period",
     .dimension = ratio,
     .meaning = "its impacts in a period of the force",
     .experiment = Experiment::steady,
     .value = one_of<&RunFindings::steady,
                     [](const SteadyState& steady) {
                       return double(steady.impacts[0] + steady.impacts[1]) / double(steady.measured_periods);
                     }>},
    {.name = "worst_steady_amplitude",
     .dimension = length,
     .meaning = "largest steady |x| over the plan's frequencies, rising and falling; none if one motion is "
                "not steady",
     .experiment = Experiment::worst,
     .better = least,
     .value = one_of<&RunFindings::worst, &RunFindings::Worst::amplitude>},
    {.name = "worst_frequency",
     .dimension = frequency,
     .meaning = "the frequency at which it is met",
     .experiment = Experiment::worst,
     .value = one_of<&RunFindings::worst, &RunFindings::Worst::frequency>},
    {.name = "lyapunov_exponent",
     .dimension = rate,
     .meaning = "largest Lyapunov exponent from the release on",
     .experiment = Experiment::lyapunov,
     .better = least,
     .value = [](RunFindings& found, double) -> Number {
       const std::vector<double>& exponents = found.exponents().exponents;
       return exponents.empty() ? std::nullopt : Number(exponents[0]);
     }},
}};

Record record_for(std::span<const KeptQuantity> kept) {
  Record record;
  for (const KeptQuantity& each : kept) {
    record.impacts |= each.quantity->of_impacts;
    record.energy |= each.quantity->of_energy;
  }
  return record;
}

}  // namespace

std::span<const Quantity> all_quantities() { return quantities; }

std::string KeptQuantity::text() const {
  std::string text(quantity->name);
  if (at) text.append(1, '=').append(number_text(*at));
  return text;
}
std::string KeptQuantity::column() const {
  std::string name(quantity->name);
  if (at) name.append(1, '_').append(number_text(*at));
  return name;
}

QuantityReading read_quantity(std::string_view text) {
  const std::size_t equals = text.find('=');
  const std::string_view name = text.substr(0, equals);
  const auto* const found = std::ranges::find(quantities, name, &Quantity::name);
  if (found == quantities.end()) {
    std::vector<std::string_view> names(quantities.size());
    std::ranges::transform(quantities, names.begin(), &Quantity::name);
    return {{},
            filled("must name a quantity (sweep --list-quantities), got {}{}", in_quotes(text),
                   did_you_mean(name, names))};
  }
  KeptQuantity kept{found, {}};
  if (!found->at) {
    if (equals == std::string_view::npos) return {kept, {}};
    return {{}, filled("must be {} without a number, got {}", name, in_quotes(text))};
  }
  if (equals != std::string_view::npos) kept.at = parse_number(text.substr(equals + 1));
  if (kept.at && *kept.at > 0) return {kept, {}};
  return {{},
          filled("must be {}={} with a number > 0, got {}", name, *found->at == length ? "A" : "L",
                 in_quotes(text))};
}

KeptNumbers none_kept(std::size_t count, const std::vector<Problem>& problems) {
  KeptNumbers none;
  none.numbers.resize(count);
  none.end = "not_valid";
  for (const std::string& line : lines_of(problems))
    none.problem += (none.problem.empty() ? "" : "; ") + line;
  return none;
}

KeptNumbers kept_of(const Scene& scene, const std::optional<Scales>& scales, const Engine& engine,
                    std::span<const KeptQuantity> kept, const ForcedRules& rules) {
  const Record record = record_for(kept);
  RunFindings findings(scene, engine, rules, scales, record);
  KeptNumbers found;
  found.numbers.reserve(kept.size());
  try {
    for (const KeptQuantity& each : kept) {
      const Quantity& quantity = *each.quantity;
      const double at = each.at ? *each.at / scale_of(*quantity.at, scales) : 0;
      Number number = quantity.value(findings, at);
      if (number) *number *= scale_of(quantity.dimension, scales);
      if (number && !std::isfinite(*number))
        throw NumericalError(each.column() + " is not finite: " + number_text(*number));
      found.numbers.push_back(number);
    }
    found.end = findings.end();
  } catch (const InvalidArguments& error) {
    return none_kept(kept.size(), error.problems());
  } catch (const NumericalError& error) {
    found.end = "failed";
    found.problem = error.what();
  }
  found.numbers.resize(kept.size());
  return found;
}

}  // namespace impact_damper
