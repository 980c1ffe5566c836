#include "impact_damper/orbits/run_with_variation.hpp"

#include <cmath>
#include <limits>
#include <type_traits>
#include <variant>

#include "impact_damper/engines/exact.hpp"
#include "impact_damper/engines/restitution.hpp"
#include "impact_damper/orbits/variation.hpp"

namespace impact_damper {
namespace {

class VariationObserver {
 public:
  VariationObserver(const Scene& scene, const std::optional<double>& zeta_m, VariationReceiver& receiver,
                    Kept kept)
      : variation_(scene, zeta_m, receiver), kept_(kept), search_{bounded_span(variation_.system())} {}

  static bool wants_half_cycles() { return false; }
  static bool wants_contacts() { return false; }
  static bool wants_energy() { return false; }
  static double next_sample() { return std::numeric_limits<double>::infinity(); }
  void half_cycle(double, double, double, double) {}
  void contact(double, double, Wall) {}
  void sample(double, double, double, double, double) {}
  EnergyBalance& energy_balance() { return unused_; }

  void impact(double time, Wall wall, double w, double) {
    if (kept_ == Kept::impacts) run_.impacts.push_back({time, wall, std::fabs(w)});
  }
  template <class Motion>
  void passed(const Motion& motion, double begin, double duration, const State<double>& end) {
    variation_.passed(motion, begin, duration, end);
    if (kept_ != Kept::impacts) return;
    if constexpr (std::is_same_v<Motion, Flight<double>>) look_for_turns(motion, duration);
    if constexpr (std::is_same_v<Motion, Stuck<double>>)
      run_.impacts_before_sticking.push_back(run_.impacts.size());
  }

  VariedRun ended(double now) {
    run_.end = variation_.end();
    run_.rates_at_end = variation_.rates_at_end(now);
    return std::move(run_);
  }

 private:
  // y turns back from the wall that it flies towards, and from then on flies towards the other.
  void look_for_turns(const Flight<double>& flight, double duration) {
    const State<double> start = flight.at(0);
    double sign = start.y == 0 ? 1 : start.y == 1 ? -1 : start.w >= 0 ? 1 : -1, from = 0;
    while (const auto turn = flight.turn_of_y(sign, from, duration, search_)) {
      const double y = flight.at(*turn).y, gap = sign > 0 ? 1 - y : y;
      if (!(run_.nearest_miss && *run_.nearest_miss <= gap)) run_.nearest_miss = gap;
      sign = -sign;
      from = *turn;
    }
  }

  Variation<double, VariationReceiver> variation_;
  Kept kept_;
  Search<double> search_;
  VariedRun run_;
  EnergyBalance unused_;
};

}  // namespace

Expected<VariedRun, StopReason> run_with_variation(const Scene& scene, const Engine& engine,
                                                   VariationReceiver& receiver, Kept kept) {
  require_arithmetic();
  const System<double> system(scene);  // not with_system(): there is a force
  const auto* const exact = std::get_if<Exact>(&engine);
  VariationObserver observer(
      scene, exact ? std::optional(zeta_m<double>(scene.damper(), exact->calibration)) : std::nullopt,
      receiver, kept);
  const Outcome outcome = exact ? run_exact(system, scene, *exact, observer)
                                : run_restitution(system, scene, std::get<Restitution>(engine), observer);
  if (outcome.stop_reason != StopReason::time) return outcome.stop_reason;
  return observer.ended(*scene.until_time);
}

}  // namespace impact_damper
