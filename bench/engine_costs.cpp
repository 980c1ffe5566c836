// What the engines themselves cost, nothing kept of their runs: memory, and time per impact.
#include <cmath>
#include <concepts>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <new>
#include <span>
#include <stdexcept>

#include "impact_damper/base/number_text.hpp"
#include "impact_damper/engines/exact.hpp"
#include "impact_damper/engines/exact_components.hpp"
#include "impact_damper/engines/recorder.hpp"
#include "impact_damper/engines/restitution.hpp"
#include "impact_damper/engines/restitution_components.hpp"
#include "impact_damper/simulate.hpp"
#include "measurements.hpp"

namespace {

thread_local std::int64_t calls = 0;

}  // namespace

void* operator new(std::size_t size) {
  ++calls;
  if (void* memory = std::malloc(size ? size : 1)) return memory;
  throw std::bad_alloc();
}
void* operator new(std::size_t size, std::align_val_t alignment) {
  ++calls;
  const std::size_t unit = std::size_t(alignment);
  if (void* memory = std::aligned_alloc(unit, (size + unit - 1) / unit * unit)) return memory;
  throw std::bad_alloc();
}
// Not inlined: beside the calls of operator new a compiler would take free() for the wrong one.
[[gnu::noinline]] void operator delete(void* memory) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete(void* memory, std::align_val_t) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete(void* memory, std::size_t, std::align_val_t) noexcept {
  std::free(memory);
}

namespace impact_damper::bench {
namespace {

// Looks at everything a decay is made of and keeps nothing but counts.
class QuietObserver {
 public:
  explicit QuietObserver(bool energy = false) : energy_(energy) {}

  bool wants_half_cycles() const { return true; }
  bool wants_contacts() const { return false; }
  bool wants_energy() const { return energy_; }

  void half_cycle(double, double, double, double) { ++rows; }
  void impact(double, Wall, double, double) { ++impacts; }
  void contact(double, double, Wall) {}
  double next_sample() const { return std::numeric_limits<double>::infinity(); }
  void sample(double, double, double, double, double) {}
  EnergyBalance& energy_balance() {
    energy_balance_.impact_loss.clear();  // the engine keeps the sum
    return energy_balance_;
  }

  std::int64_t rows = 0, impacts = 0;

 private:
  bool energy_;
  EnergyBalance energy_balance_;
};

template <class Options>
void run_by(const Checked& run, auto& observer) {
  if constexpr (std::same_as<Options, Exact>) {
    run_exact<double>(run, observer);
  } else {
    run_restitution<double>(run, observer);
  }
}

template <class Options>
Allocations count_with(const Scene& decay, const Options& options) {
  Allocations counted{.engine = std::string(Options::name)};
  const Checked run = checked(decay, options);
  QuietObserver quiet;
  const std::int64_t begin = calls;
  run_by<Options>(run, quiet);
  counted.quiet = calls - begin;
  counted.impacts = quiet.impacts;

  Recorder recorder({.half_cycles = true});
  const std::int64_t begin_recorded = calls;
  run_by<Options>(run, recorder);
  counted.recorded = calls - begin_recorded;
  if (counted.recorded == 0) throw std::logic_error("allocations are not counted");
  return counted;
}

template <class Options>
SweepPoint measure_point(double at, const Scene& scene, const Options& options) {
  SweepPoint point{.at = at};
  QuietObserver accountant(true);
  run_by<Options>(checked(scene, options), accountant);
  point.impacts = accountant.impacts;
  point.half_cycles = accountant.rows;
  point.residual = std::abs(accountant.energy_balance().residual);

  const auto once = [&] {
    QuietObserver observer;
    run_by<Options>(checked(scene, options), observer);
  };
  const double first = cpu_seconds(once);
  point.timing = measure(once, first < 1 ? 9 : 3, first);
  return point;
}

template <class Options>
void add_sweeps(double most_impacts, const std::function<void(const std::string&)>& told,
                std::vector<Sweep>& all) {
  const std::string name(Options::name);
  const auto add = [&](Sweep& sweep, double at, const Scene& scene, const Options& options) {
    told(name + ", cost against " + sweep.against + ": " + number_text(at));
    sweep.points.push_back(measure_point(at, scene, options));
  };

  Sweep impacts{name, "impacts", "number of impacts, e = 1", {}};
  for (double n = 100; n <= most_impacts; n *= 10) {
    Options options;
    options.budget.max_impacts = std::int64_t(n);
    add(impacts, n, {.x0 = 6, .until_time = 1e12, .dampers = {{.restitution = 1}}}, options);
  }
  all.push_back(impacts);

  if constexpr (std::same_as<Options, Exact>) {
    Sweep stiffness{name, "stiffness", "wall stiffness k, e = 0.6, decay from 6 to 0.5", {}};
    for (double k = 1e2; k < 2e10; k *= 10) {
      add(stiffness, k, {.x0 = 6, .until_amplitude = 0.5, .dampers = {{.wall_stiffness = k}}}, {});
    }
    all.push_back(stiffness);
  }

  Sweep restitution{name, "restitution", "restitution e, decay from 6 to 0.5", {}};
  for (const double e : {0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.99}) {
    Options options;
    options.budget.max_impacts = 20'000;
    add(restitution, e, {.x0 = 6, .until_amplitude = 0.5, .dampers = {{.restitution = e}}}, options);
  }
  all.push_back(restitution);
}

// Counts the events of a run with one damper: the beginnings and ends of contacts, and where there are
// components also stops and releases, after each of which an engine decides anew who is held.
class EventCounter {
 public:
  bool wants_half_cycles() const { return false; }
  bool wants_contacts() const { return true; }
  bool wants_energy() const { return false; }
  void half_cycle(double, double, double, double) {}
  void impact(double, Wall, double, double, std::int32_t = 0) { ++impacts_; }
  void contact(double, double, Wall, std::int32_t = 0) { ++contacts_; }
  double next_sample() const { return std::numeric_limits<double>::infinity(); }
  void sample(double, double, double, double, double) {}
  void sample(double, double, double, std::span<const PlaceInCavity>) {}
  EnergyBalance& energy_balance() { return energy_balance_; }
  void settled(std::int32_t, PlaceInCavity, bool, double, bool) { ++settled_; }

  std::int64_t impacts() const { return impacts_; }
  // Of the calls of settled() the first is that of the release.
  std::int64_t events() const { return settled_ > 0 ? settled_ - 1 : impacts_ + contacts_; }

 private:
  std::int64_t impacts_ = 0, contacts_ = 0, settled_ = 0;
  EnergyBalance energy_balance_;
};

struct Component {
  std::string name;
  double bound;
  Scene scene;
};

template <class Options>
EventCounter count_events(const Scene& scene, const Options& options) {
  EventCounter counter;
  const Checked run = checked(scene, options);
  if (!has_components(scene))
    run_by<Options>(run, counter);
  else if constexpr (std::same_as<Options, Exact>)
    run_exact_with_components<double>(run, counter);
  else
    run_restitution_with_components<double>(run, counter);
  return counter;
}

template <class Options>
ComponentCost measure_component(const Component& component, const Options& options, int repeats) {
  const Scene plain{.x0 = 6, .until_amplitude = 0.5};
  const EventCounter with = count_events(component.scene, options), without = count_events(plain, options);
  const auto seconds = [&](const Scene& scene) {
    return cpu_seconds([&] {
      for (int i = 0; i < 20; ++i) simulate(scene, options, {.half_cycles = false, .impacts = true});
    });
  };
  std::vector<double> per_event, per_impact;
  for (int i = 0; i < repeats; ++i) {
    const double ratio = seconds(component.scene) / seconds(plain);
    per_event.push_back(ratio * double(without.events()) / double(with.events()));
    per_impact.push_back(ratio * double(without.impacts()) / double(with.impacts()));
  }
  return {std::string(Options::name), component.name, component.bound, spread_of(per_event),
          spread_of(per_impact)};
}

}  // namespace

std::vector<ComponentCost> measure_components(int repeats) {
  const auto with = [](double weight, const SceneDamper& damper) {
    return Scene{.x0 = 6, .weight = weight, .until_amplitude = 0.5, .dampers = {damper}};
  };
  const std::vector<Component> components{{"friction", 1.5, with(0, {.friction = 1e-3})},
                                          {"weight", 1.5, with(1e-3, {})},
                                          {"drag", 3, with(0, {.drag = 1e-3})}};
  std::vector<ComponentCost> all;
  for (const Component& each : components) {
    all.push_back(measure_component(each, Exact{}, repeats));
    all.push_back(measure_component(each, Restitution{}, repeats));
  }
  return all;
}

std::vector<Allocations> count_allocations() {
  const Scene decay{.x0 = 6, .until_amplitude = 0.03};
  return {count_with(decay, Exact{}), count_with(decay, Restitution{})};
}

std::vector<Sweep> measure_sweeps(double most_impacts, const std::function<void(const std::string&)>& told) {
  std::vector<Sweep> all;
  add_sweeps<Exact>(most_impacts, told, all);
  add_sweeps<Restitution>(most_impacts, told, all);
  return all;
}

}  // namespace impact_damper::bench
