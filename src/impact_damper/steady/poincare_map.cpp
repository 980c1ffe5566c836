#include "impact_damper/steady/poincare_map.hpp"

#include <algorithm>
#include <cmath>

#include "impact_damper/steady/run_with_variation.hpp"

namespace impact_damper {
namespace {

// The product of all steps, and what the parameters add up to.
class Product final : public VariationReceiver {
 public:
  using VariationReceiver::VariationReceiver;
  void joined() override {}
  int pieces(double) override { return 1; }

  RowsOfState<double, 4> by_state = identity<double>();
  RowsOfState<double, 2> by_parameters{};

 private:
  void take(const RowsOfState<double, 4>& a, const RowsOfState<double, 2>* added) override {
    by_state = product(a, by_state);
    if (!added) return;
    by_parameters = product(a, by_parameters);
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t j = 0; j < 2; ++j) by_parameters[i][j] += (*added)[i][j];
  }
};

// Complete chattering counts with its first impact only: those behind it are as slow as one likes.
std::optional<double> slowest(const std::vector<OrbitImpact>& impacts,
                              const std::vector<std::size_t>& impacts_before_sticking) {
  std::vector<bool> counts(impacts.size(), true);
  for (const std::size_t end : impacts_before_sticking)
    for (std::size_t i = end; i-- > 1 && impacts[i - 1].wall == impacts[i].wall;) counts[i] = false;
  std::optional<double> least;
  for (std::size_t i = 0; i < impacts.size(); ++i)
    if (counts[i] && !(least && *least <= impacts[i].speed)) least = impacts[i].speed;
  return least;
}

}  // namespace

StateVector vector_of(const State<double>& s) { return {s.x, s.v, s.y, s.w}; }
State<double> state_of(const StateVector& s) { return {s[0], s[1], s[2], s[3]}; }
StateVector product(const StateMatrix& a, const StateVector& s) {
  StateVector t{};
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t k = 0; k < 4; ++k) t[i] += a[i][k] * s[k];
  return t;
}

PoincareMap::PoincareMap(const Scene& scene, const Engine& engine, int half_periods)
    : scene_(scene), engine_(engine), half_periods_(half_periods) {
  scene_.x0 = scene_.v0 = scene_.w0 = 0;
  scene_.y0 = 0.5;
  scene_.until_amplitude.reset();
  scene_.until_time = half_periods * (half_turn<double>() / scene.force_frequency);
  std::vector<Problem> problems = problems_of(scene_);
  for (const Problem& problem : problems_of(engine)) problems.push_back(problem);
  if (!(half_periods >= 1)) problems.push_back({"periods", "must be >= 1"});
  if (scene.force_amplitude == 0) problems.push_back({"force_amplitude", "must not be 0"});
  if (std::holds_alternative<Cem>(engine))
    problems.push_back({"engine", "must be exact or restitution, got cem"});
  require_none(problems);
}

PoincareImage PoincareMap::operator()(const State<double>& s, Derivatives wanted) const {
  Scene scene = scene_;
  scene.x0 = s.x, scene.v0 = s.v, scene.y0 = s.y, scene.w0 = s.w;
  Product all(wanted == Derivatives::by_state_and_parameters);
  VariedRun run = run_with_variation(scene, engine_, all, Kept::impacts);
  PoincareImage image;
  image.stop_reason = run.stop_reason;
  if (image.stop_reason != StopReason::time) return image;

  // The end of the time moves with omega_f (M13.8).
  const double mirror = half_periods_ % 2 == 0 ? 1 : -1;
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t j = 0; j < 4; ++j) image.by_state[i][j] = mirror * all.by_state[i][j];
    image.by_frequency[i] =
        mirror * (all.by_parameters[i][0] - run.rates_at_end[i] * (duration() / scene.force_frequency));
    image.by_amplitude[i] = mirror * all.by_parameters[i][1];
  }
  const State<double>& end = run.end;
  image.state = mirror == 1 ? end : State<double>{-end.x, -end.v, 1 - end.y, -end.w};
  image.sticking = std::int64_t(run.impacts_before_sticking.size());
  image.slowest_impact = slowest(run.impacts, run.impacts_before_sticking);
  image.nearest_miss = run.nearest_miss;
  image.impacts = std::move(run.impacts);
  return image;
}

}  // namespace impact_damper
