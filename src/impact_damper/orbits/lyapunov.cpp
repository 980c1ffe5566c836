#include "impact_damper/orbits/lyapunov.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <utility>

#include "impact_damper/math/dense.hpp"
#include "impact_damper/math/elementary.hpp"
#include "impact_damper/orbits/poincare_map.hpp"
#include "impact_damper/orbits/variational_equations.hpp"
#include "impact_damper/steady/steady_state.hpp"

namespace impact_damper {
namespace {

// A motion period by period, with a frame of orthonormal changes of the state, the Q of (M13.15), and the
// logarithms of their stretches. Each period is a run of its own, so that the phase of the force does not
// drift.
class MotionWithFrame {
 public:
  MotionWithFrame(const Scene& scene, const Engine& engine)
      : scene_(scene, engine),
        coefficients_(variational_coefficients(scene, engine)),
        state_(release_of(scene)),
        columns_(identity_of(dimensions_of(scene))),
        logarithms_(columns_.size()) {}
  double duration() const { return scene_.period(); }
  StopReason pass_period() {
    const RecordedRun run = scene_.record(state_, duration());
    if (run.stop_reason != StopReason::time) return run.stop_reason;
    const Carried carried = carry_changes(*coefficients_, run, columns_, [&] {
      for (std::size_t j = 0; j < columns_.size(); ++j)
        if (const auto stretch = orthonormalise(columns_, j)) logarithms_[j] += logarithm(*stretch);
    });
    lost_ = std::max(lost_, carried.lost);
    one_sided_ = one_sided_ || carried.one_sided;
    state_ = run.end;
    return run.stop_reason;
  }
  void begin_to_average() {
    complete_basis(columns_, dimensions());
    lost_ = 0;
    one_sided_ = false;
    logarithms_.assign(logarithms_.size(), 0.0);
  }
  const std::vector<double>& logarithms() const { return logarithms_; }
  std::size_t dimensions() const { return columns_.size() - lost_; }
  bool one_sided() const { return one_sided_; }

 private:
  ForcedScene scene_;
  std::shared_ptr<const VariationalCoefficients> coefficients_;
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
  for (const Problem& each : problems_of(scene, engine)) problems.push_back(each);
  require_none(problems);
  MotionWithFrame motion(scene, engine);
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
    const std::vector<double>& now = motion.logarithms();
    std::vector<double> mean(now.size());
    for (std::size_t j = 0; j < now.size(); ++j)
      mean[j] = (now[j] - before[j]) / (double(used - begun) * motion.duration());
    means.push_back(std::move(mean));
    before = now;
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

}  // namespace impact_damper
