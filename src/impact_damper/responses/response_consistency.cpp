#include <algorithm>
#include <cmath>

#include "impact_damper/base/number_text.hpp"
#include "impact_damper/math/elementary.hpp"
#include "impact_damper/orbits/variational_equations.hpp"
#include "impact_damper/responses/response_file.hpp"

namespace impact_damper {
namespace {

class Examination {
 public:
  std::vector<Problem> examined(const Response& response) {
    std::visit([&](const auto& each) { examine(each); }, response);
    return std::move(problems_);
  }

 private:
  void require(bool holds, const std::string& field, const std::string& message) {
    if (!holds) problems_.push_back({field, message});
  }

  // The entry of a column: "/sweeps/0/up/", "power", "/3".
  static std::string place(std::string_view before, std::string_view column, std::string_view row) {
    return std::string(before).append(column).append(row);
  }

  void examine(const SweepResponse& response) {
    for (std::size_t n = 0; n < response.sweeps.size(); ++n) {
      const std::string sweep = "/sweeps/" + std::to_string(n);
      examine_way(response, sweep + "/up/", response.sweeps[n].up);
      examine_way(response, sweep + "/down/", response.sweeps[n].down);
    }
  }

  void examine_way(const SweepResponse& response, const std::string& way,
                   const std::vector<SteadyState>& states) {
    for (std::size_t i = 0; i < states.size(); ++i) {
      const SteadyState& s = states[i];
      const std::string row = '/' + std::to_string(i);
      examine_sum(way, row, s.impacts, s.impacts_by_damper);
      require(!s.contraction || s.period, place(way, "contraction", row),
              "must be null: the motion is not periodic");
      require(s.transient_periods <= response.rule.max_periods, place(way, "transient_periods", row),
              "must be <= max_periods, got " + std::to_string(s.transient_periods));
      if (!s.means) continue;
      const std::int64_t measured = s.period.value_or(response.rule.mean_periods);
      require(s.measured_periods == measured, place(way, "measured_periods", row),
              "must be " + std::to_string(measured) + ", got " + std::to_string(s.measured_periods));
      examine_means(response, way, row, response.axis.at(response.scene, std::int64_t(i)), s);
    }
  }

  void examine_sum(const std::string& way, const std::string& row, const ImpactCounts& impacts,
                   const std::vector<ImpactCounts>& by_damper) {
    for (const std::size_t wall : {0, 1}) {
      std::int64_t all = by_damper.empty() ? impacts[wall] : 0;
      for (const ImpactCounts& each : by_damper) all += each[wall];
      require(impacts[wall] == all, place(way, wall == 0 ? "impacts_left" : "impacts_right", row),
              "must be " + std::to_string(all) + ", the sum over the dampers, got " +
                  std::to_string(impacts[wall]));
    }
  }

  void examine_means(const SweepResponse& response, const std::string& way, const std::string& row,
                     const Scene& scene, const SteadyState& s) {
    const SteadyMeans& means = *s.means;
    const double f0 = std::abs(scene.force_amplitude), omega = scene.force_frequency;
    // The power of the force, the mean of f0 sin(omega t) times the velocity of (M14.4), to 1e-9 of the
    // largest that it can be: lag and fundamental are rounded, and their part in quadrature may be much
    // larger.
    const auto [behind, in_phase] = sin_cos(means.lag_deg * (half_turn<double>() / 180));
    const double power = f0 * omega * means.fundamental * behind / 2;
    const double scale = f0 * omega * means.fundamental * (std::abs(behind) + std::abs(in_phase));
    require(std::abs(means.power - power) <= 1e-9 * scale, place(way, "power", row),
            "must be " + number_text(power) + ", that of the fundamental, got " + number_text(means.power));
    require(scene.damping_ratio > 0 ? means.viscous_power >= 0 : means.viscous_power == 0,
            place(way, "viscous_power", row),
            "must be " + std::string(scene.damping_ratio > 0 ? ">= 0" : "0 without damping") + ", got " +
                number_text(means.viscous_power));
    if (!s.period) return;
    // The distance left to the periodic motion changes the energy, of the order of the state squared.
    const double size = size_of(s.state), allowed = 100 * response.rule.tolerance * size * size * (1 + omega);
    const double out = means.viscous_power + means.impact_power;
    require(std::abs(means.power - out) <= allowed, place(way, "power", row),
            "must be " + number_text(out) + ", what damper and impacts take out, got " +
                number_text(means.power));
    require(s.amplitude_scatter == 0 && s.power_scatter == 0, place(way, "amplitude_scatter", row),
            "must be 0, as that of the power: the motion is periodic");
    require(
        std::abs(s.state.x) <= means.amplitude + allowed, place(way, "x", row),
        "must not exceed the amplitude, " + number_text(means.amplitude) + ", got " + number_text(s.state.x));
    examine_symmetry(place(way, "symmetric", row), s.symmetric, *s.period, s.impacts);
  }

  void examine_symmetry(const std::string& field, bool symmetric, std::int64_t period,
                        const ImpactCounts& impacts) {
    require(!symmetric || (period % 2 == 1 && impacts[0] == impacts[1]), field,
            "must be false: its period is even, or it strikes one wall more often than the other");
  }

  void examine(const BasinResponse& response) {
    std::int64_t before = std::int64_t(response.basin.attractor.size());
    for (std::size_t i = 0; i < response.basin.attractors.size(); ++i) {
      const Attractor& each = response.basin.attractors[i];
      const std::string item = "/attractors/" + std::to_string(i);
      require(!each.idle || (each.impacts == ImpactCounts{} && each.period == 1), item + "/idle",
              "must be false: it has impacts, or a period longer than the force's");
      examine_symmetry(item + "/symmetric", each.symmetric, each.period, each.impacts);
      require(each.points <= before, item + "/points",
              "must not exceed that of the one before, " + std::to_string(before) + ", got " +
                  std::to_string(each.points));
      before = each.points;
    }
  }

  void examine(const OrbitsResponse& response) {
    const std::int64_t starts = std::int64_t(response.starts.size()),
                       branches = std::int64_t(response.branches.size());
    for (std::int64_t i = 0; i < starts; ++i) {
      const auto& branch = response.starts[std::size_t(i)].branch;
      require(!branch || *branch < branches, "/starts/" + std::to_string(i) + "/branch",
              "must be the index of a branch");
    }
    for (std::int64_t i = 0; i < branches; ++i) {
      const OrbitBranch& branch = response.branches[std::size_t(i)];
      const std::string item = "/branches/" + std::to_string(i);
      const bool of_start = branch.origin == BranchOrigin::start;
      require(branch.from < (of_start ? starts : i), item + "/from",
              of_start ? "must be the index of a start" : "must be the index of a branch before it");
      if (branch.event && !of_start && branch.from < i)
        require(*branch.event < std::int64_t(response.branches[std::size_t(branch.from)].events.size()),
                item + "/event", "must be the index of an event of the branch that it comes from");
      for (std::size_t p = 0; p < branch.points.size(); ++p)
        examine_point(item + '/', '/' + std::to_string(p), branch.points[p]);
    }
  }

  void examine_point(const std::string& branch, const std::string& row, const OrbitPoint& point) {
    const bool struck = point.impacts != ImpactCounts{};
    const bool stable = struck && point.multipliers[0].modulus() < 1;
    require(point.stable == stable, place(branch, "stable", row),
            "must be " + std::string(stable ? "true" : "false") + " by its multipliers and impacts");
    for (std::size_t i = 1; i < 4; ++i)
      require(point.multipliers[i].modulus() <= point.multipliers[i - 1].modulus() * (1 + 1e-9),
              place(branch, "multiplier_" + std::to_string(i + 1) + "_re", row),
              "must not exceed the one before in modulus");
    examine_sum(branch, row, point.impacts, point.impacts_by_damper);
    examine_symmetry(place(branch, "symmetric", row), point.symmetric, point.period, point.impacts);
    // A simulation drifts away from an unstable orbit (FollowedBranch::amplitudes).
    require(std::abs(point.state.x) <= point.amplitude + 1e-5, place(branch, "x", row),
            "must not exceed the amplitude, " + number_text(point.amplitude) + ", got " +
                number_text(point.state.x));
  }

  void examine(const LyapunovResponse& response) {
    const LyapunovExponents& found = response.found;
    const bool is_complete = found.stop_reason == StopReason::time;
    const std::size_t count = found.exponents.size();
    // Each mass that sticks takes two exponents away.
    const std::size_t most = dimensions_of(response.scene);
    const std::string allowed = !is_complete ? "none"
                                : most == 4  ? "four or two"
                                             : "an even number of them, 2 to " + std::to_string(most);
    require(is_complete ? count >= 2 && count <= most && count % 2 == 0 : count == 0, "/exponents",
            "must be " + allowed + ", got " + std::to_string(count));
    require(found.standard_errors.size() == count, "/standard_errors",
            "must be as many as there are exponents, got " + std::to_string(found.standard_errors.size()));
  }

  std::vector<Problem> problems_;
};

}  // namespace

std::vector<Problem> inconsistencies_of(const Response& response) { return Examination().examined(response); }

}  // namespace impact_damper
