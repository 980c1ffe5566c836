#include "impact_damper/orbits/lyapunov.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <string>
#include <utility>

#include "impact_damper/engines/compatibility.hpp"
#include "impact_damper/math/dense.hpp"
#include "impact_damper/math/elementary.hpp"
#include "impact_damper/orbits/poincare_map.hpp"
#include "impact_damper/orbits/run_with_variation.hpp"
#include "impact_damper/orbits/variation_of_dampers.hpp"
#include "impact_damper/steady/steady_state.hpp"

namespace impact_damper {
namespace {

using FourNumbers = std::array<double, 4>;

// Makes column j orthonormal to those before it, and adds the logarithm of the length that it had, its
// stretch (M13.15).
template <class Columns>
void take_stretch(Columns& columns, std::size_t j, double& logarithm_of_stretch) {
  if (const auto stretch = orthonormalise(columns, j)) logarithm_of_stretch += logarithm(*stretch);
}

// The frame Q of (M13.15): four orthonormal changes of the state, and the logarithms of their stretches.
class Frame final : public VariationReceiver {
 public:
  Frame() : VariationReceiver(false) {}
  void joined() override { dimensions_ = 2; }
  int pieces(double loss) override {
    if (is_lost(loss)) joined();
    return pieces_of(loss);
  }
  void begin_to_average() {
    complete_basis(columns_, dimensions_);
    dimensions_ = 4;
    logarithms_ = {};
  }
  const FourNumbers& logarithms() const { return logarithms_; }
  std::size_t dimensions() const { return dimensions_; }

 private:
  void take(const RowsOfState<double, 4>& a, const RowsOfState<double, 2>*) override {
    for (std::size_t j = 0; j < 4; ++j) {
      FourNumbers carried{};
      for (std::size_t i = 0; i < 4; ++i)
        for (std::size_t k = 0; k < 4; ++k) carried[i] += a[i][k] * columns_[j][k];
      columns_[j] = carried;
      take_stretch(columns_, j, logarithms_[j]);
    }
  }

  RowsOfState<double, 4> columns_ = identity<double>();
  FourNumbers logarithms_{};
  std::size_t dimensions_ = 4;
};

// A scene with one damper, period by period. Each period is a run of its own, so that the phase of the force
// does not drift.
class OneDamper {
 public:
  OneDamper(const Scene& scene, const Engine& engine)
      : engine_(engine), period_(PoincareMap(scene, engine, 2).scene()) {
    period_ = released_from(std::move(period_), release_of(scene));
    require_none(incompatibilities_of(period_, engine));
  }
  double duration() const { return *period_.until_time; }
  StopReason pass_period() {
    const auto run = run_with_variation(period_, engine_, frame_, Kept::end);
    if (!run) return run.failure();
    const State<double>& end = run->end;
    period_.x0 = end.x, period_.v0 = end.v;
    period_.damper().y0 = end.y, period_.damper().w0 = end.w;
    return StopReason::time;
  }
  void begin_to_average() { frame_.begin_to_average(); }
  std::span<const double> logarithms() const { return frame_.logarithms(); }
  std::size_t dimensions() const { return frame_.dimensions(); }
  static bool one_sided() { return false; }

 private:
  const Engine& engine_;
  Scene period_;
  Frame frame_;
};

// A scene with a list of dampers, in the same way, from the record of each period.
class SeveralDampers {
 public:
  SeveralDampers(const Scene& scene, const Engine& engine)
      : scene_(scene, engine), state_(release_of(scene)) {
    columns_ = identity_of(dimensions_of(scene));
    logarithms_.assign(columns_.size(), 0.0);
  }
  double duration() const { return scene_.period(); }
  StopReason pass_period() {
    const Run run = scene_.record(state_, duration());
    if (run.stop_reason != StopReason::time) return run.stop_reason;
    const Carried carried = carry_changes(run, columns_, [&] {
      for (std::size_t j = 0; j < columns_.size(); ++j) take_stretch(columns_, j, logarithms_[j]);
    });
    lost_ = std::max(lost_, carried.lost);
    one_sided_ = one_sided_ || carried.one_sided;
    state_ = state_in(*run.history, 1);
    return run.stop_reason;
  }
  void begin_to_average() {
    complete_basis(columns_, dimensions());
    lost_ = 0;
    one_sided_ = false;
    logarithms_.assign(logarithms_.size(), 0.0);
  }
  std::span<const double> logarithms() const { return logarithms_; }
  std::size_t dimensions() const { return columns_.size() - lost_; }
  bool one_sided() const { return one_sided_; }

 private:
  ForcedScene scene_;
  SceneState state_;
  std::vector<ChangeOfState> columns_;
  std::vector<double> logarithms_;
  std::size_t lost_ = 0;
  bool one_sided_ = false;
};

constexpr std::int64_t error_blocks = 10;

// The standard error of exponent j from its means over the blocks.
double standard_error(const std::vector<std::vector<double>>& means, std::size_t j) {
  const auto count = double(means.size());
  double mean = 0, squares = 0;
  for (const std::vector<double>& each : means) mean += each[j] / count;
  for (const std::vector<double>& each : means) squares += (each[j] - mean) * (each[j] - mean);
  return std::sqrt(squares / (count - 1) / count);
}

template <class Motion>
LyapunovExponents exponents_of(Motion&& motion, std::int64_t periods, std::int64_t skipped,
                               const std::function<void(std::int64_t done)>& progress) {
  LyapunovExponents result;
  std::vector<std::vector<double>> means;                       // of the blocks
  std::vector<double> before(motion.logarithms().size(), 0.0);  // when the block began
  std::int64_t begun = 0;                                       // periods that were used by then
  for (std::int64_t n = 0; n < skipped + periods; ++n) {
    if (n == skipped) motion.begin_to_average();  // a mass that stuck before may never do so again
    result.stop_reason = motion.pass_period();
    if (result.stop_reason != StopReason::time) return result;
    if (progress) progress(n + 1);

    // Blocks differ by one period where their number does not divide that of the periods.
    const std::int64_t used = n + 1 - skipped;
    if (used < 1 || used != periods * (std::ssize(means) + 1) / error_blocks) continue;
    const std::span<const double> now = motion.logarithms();
    std::vector<double> mean(now.size());
    for (std::size_t j = 0; j < now.size(); ++j)
      mean[j] = (now[j] - before[j]) / (double(used - begun) * motion.duration());
    means.push_back(std::move(mean));
    before.assign(now.begin(), now.end());
    begun = used;
  }
  result.periods = periods;
  result.one_sided = motion.one_sided();
  for (std::size_t j = 0; j < motion.dimensions(); ++j) {
    result.exponents.push_back(motion.logarithms()[j] / (double(periods) * motion.duration()));
    if (periods >= error_blocks) result.standard_errors.push_back(standard_error(means, j));
  }
  return result;
}

}  // namespace

LyapunovExponents lyapunov_exponents(const Scene& scene, const Engine& engine, std::int64_t periods,
                                     std::int64_t skipped,
                                     const std::function<void(std::int64_t done)>& progress) {
  std::vector<Problem> problems;
  if (!(periods >= 1)) problems.push_back({"periods", "must be >= 1"});
  if (!(skipped >= 0)) problems.push_back({"skipped", "must be >= 0"});
  if (scene.dampers.size() > most_dampers_with_changes)
    problems.push_back({"dampers", "must be at most " + std::to_string(most_dampers_with_changes) +
                                       " for exponents, got " + std::to_string(scene.dampers.size())});
  require_none(problems);
  return has_one_damper(scene) ? exponents_of(OneDamper(scene, engine), periods, skipped, progress)
                               : exponents_of(SeveralDampers(scene, engine), periods, skipped, progress);
}

}  // namespace impact_damper
