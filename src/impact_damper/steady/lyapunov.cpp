#include "impact_damper/steady/lyapunov.hpp"

#include <array>
#include <cmath>

#include "impact_damper/engines/compatibility.hpp"
#include "impact_damper/steady/poincare_map.hpp"
#include "impact_damper/steady/run_with_variation.hpp"

namespace impact_damper {
namespace {

double dot(const StateVector& a, const StateVector& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3];
}

// Four orthonormal changes of the state, and the logarithms of what they have been stretched by (M13.15).
class Frame final : public VariationReceiver {
 public:
  Frame() : VariationReceiver(false) {}
  void joined() override { dimensions_ = 2; }
  // Each contracts volumes by at most e; what one contracts by more than exp(-36) is lost in rounding errors.
  int pieces(double loss) override {
    constexpr int most = 4096;
    if (loss > 36.0 * most) joined();
    return loss < most ? 1 + int(loss) : most;
  }
  void forget_logarithms() { logarithms_ = {}; }
  const StateVector& logarithms() const { return logarithms_; }
  std::size_t dimensions() const { return dimensions_; }

 private:
  // Orthogonal to the ones before it, by modified Gram-Schmidt, twice: an impact that is slow shears so much
  // that once would leave rounding errors.
  void take(const StateMatrix& a, const RowsOfState<double, 2>*) override {
    for (std::size_t j = 0; j < 4; ++j) {
      StateVector& column = columns_[j] = product(a, columns_[j]);
      for (int pass = 0; pass < 2; ++pass) {
        for (std::size_t k = 0; k < j; ++k) {
          const double along = dot(columns_[k], column);
          for (std::size_t i = 0; i < 4; ++i) column[i] -= along * columns_[k][i];
        }
      }
      const double size = std::sqrt(dot(column, column));
      if (!(size > 0)) continue;  // lost
      for (double& entry : column) entry /= size;
      logarithms_[j] += logarithm(size);
    }
  }

  std::array<StateVector, 4> columns_ = identity<double>();
  StateVector logarithms_{};
  std::size_t dimensions_ = 4;
};

constexpr std::int64_t error_blocks = 10;

// What an exponent's means over blocks say of the error of the mean over all.
double standard_error(const std::vector<StateVector>& means, std::size_t j) {
  const auto count = double(means.size());
  double mean = 0, squares = 0;
  for (const StateVector& each : means) mean += each[j] / count;
  for (const StateVector& each : means) squares += (each[j] - mean) * (each[j] - mean);
  return std::sqrt(squares / (count - 1) / count);
}

}  // namespace

LyapunovExponents lyapunov_exponents(const Scene& scene, const Engine& engine, std::int64_t periods,
                                     std::int64_t skipped,
                                     const std::function<void(std::int64_t done)>& progress) {
  std::vector<Problem> problems;
  if (!(periods >= 1)) problems.push_back({"periods", "must be >= 1"});
  if (!(skipped >= 0)) problems.push_back({"skipped", "must be >= 0"});
  require_none(problems);
  const PoincareMap map(scene, engine, 2);

  // Each period is a run of its own, so that the phase of the force does not drift.
  Scene period = map.scene();
  period.x0 = scene.x0, period.v0 = scene.v0, period.y0 = scene.y0, period.w0 = scene.w0;
  require_none(incompatibilities_of(period, engine));
  LyapunovExponents result;
  Frame frame;
  std::vector<StateVector> means;  // of the blocks
  StateVector before{};            // logarithms when the block began
  std::int64_t begun = 0;          // periods that were used by then
  for (std::int64_t n = 0; n < skipped + periods; ++n) {
    if (n == skipped) frame.forget_logarithms();
    const VariedRun run = run_with_variation(period, engine, frame, Kept::end);
    result.stop_reason = run.stop_reason;
    if (result.stop_reason != StopReason::time) return result;
    const State<double>& end = run.end;
    period.x0 = end.x, period.v0 = end.v, period.y0 = end.y, period.w0 = end.w;
    if (progress) progress(n + 1);

    // Blocks differ by one period where their number does not divide that of the periods.
    const std::int64_t used = n + 1 - skipped;
    if (used < 1 || used != periods * (std::ssize(means) + 1) / error_blocks) continue;
    StateVector mean = frame.logarithms();
    for (std::size_t j = 0; j < 4; ++j)
      mean[j] = (mean[j] - before[j]) / (double(used - begun) * map.duration());
    means.push_back(mean);
    before = frame.logarithms();
    begun = used;
  }
  result.periods = periods;
  for (std::size_t j = 0; j < frame.dimensions(); ++j) {
    result.exponents.push_back(frame.logarithms()[j] / (double(periods) * map.duration()));
    if (periods >= error_blocks) result.standard_errors.push_back(standard_error(means, j));
  }
  return result;
}

}  // namespace impact_damper
