// Figures C, D and E: steady motions under a force, over its frequency and its amplitude.
#include <algorithm>
#include <array>
#include <cmath>

#include "application/reproduction/measures_parts.hpp"
#include "application/reproduction/series.hpp"
#include "impact_damper/analysis/design.hpp"
#include "impact_damper/analysis/theory.hpp"
#include "impact_damper/base/number_text.hpp"
#include "impact_damper/math/elementary.hpp"

namespace impact_damper {
namespace {

constexpr const char *of_frequency = "frequency of the force, divided by Omega_n",
                     *of_force = "f0 / nu, amplitude of the force divided by K epsilon and nu",
                     *of_amplitude = "largest |x|, divided by the clearance";

// Points of a block of two columns; without points there is no block.
struct Points : Curve {
  std::vector<std::size_t> gaps;

  void interrupt() {
    if (!x.empty()) gaps.push_back(x.size());
  }
};
void add_block(Table& table, const std::string& name, const char* of_x, const std::string& legend,
               const char* of_y, const Points& points, std::vector<std::string> notes = {}) {
  if (points.x.empty()) return;
  table.add({.name = name,
             .notes = std::move(notes),
             .columns = {{"x", of_x, points.x}, {legend, of_y, points.y}},
             .gaps = points.gaps});
}

// Adds the linear response with the damper's mass locked, or without it; resonance without damping leaves a
// gap.
void add_linear_block(Table& table, const std::string& name, const std::string& legend, const Scene& scene,
                      const Axis& axis, double mass) {
  constexpr std::int64_t each = 4;  // points between two values of the axis
  const Axis fine{axis.number, axis.from, axis.to, each * (axis.count - 1) + 1};
  Points points;
  for (const double frequency : fine.values()) {
    const double amplitude = linear_response(scene.force_amplitude, mass, scene.damping_ratio, frequency);
    if (std::isfinite(amplitude)) {
      points.add(frequency, amplitude);
    } else {
      points.interrupt();
    }
  }
  add_block(table, name, of_frequency, legend, of_amplitude, points);
}

// Adds the closed form of plastic impacts for amplitudes up to `most`: where there are two frequencies for an
// amplitude, up the lower one and down the upper one, which meet where they begin or cease to be there.
void add_plastic_block(Table& table, const std::string& name, const Scene& scene, const Axis& axis,
                       double most) {
  constexpr int count = 401;
  const double least = fold_amplitude(0);
  std::vector<double> amplitudes;
  std::vector<std::vector<double>> frequencies;
  for (int k = 0; k < count; ++k) {
    amplitudes.push_back(least * exponential(logarithm(most / least) * k / (count - 1)));
    frequencies.push_back(
        plastic_frequencies(scene.damper().mass_ratio, scene.force_amplitude, amplitudes.back()));
  }
  Points points;
  const auto add = [&](int k, bool upper) {
    if (!upper && frequencies[k].size() < 2) return;
    const double frequency = upper ? frequencies[k].back() : frequencies[k].front();
    if (frequency >= axis.from && frequency <= axis.to) points.add(frequency, amplitudes[k]);
  };
  for (int first = 0; first < count; ++first) {
    if (frequencies[first].empty()) continue;
    int end = first;
    while (end < count && !frequencies[end].empty()) ++end;
    points.interrupt();
    for (int k = first; k < end; ++k) add(k, false);
    if (end == count) points.interrupt();
    for (int k = end; k-- > first;) add(k, true);
    if (first > 0) add(first, false);
    first = end;
  }
  add_block(table, name, of_frequency, "two impacts, closed form", of_amplitude, points,
            {"for nu -> 0, zeta = 0"});
}

// The steady motions under one force that are drawn, from sweeps and from branches.
struct Panel {
  double force = 0;
  Points rising, falling, rising_open, falling_open, stable, unstable;
};

void add_ways(Panel& panel, const SweepResponse& response) {
  const auto add = [&](const std::vector<SteadyState>& way, Points& periodic, Points& open) {
    for (std::size_t i = 0; i < way.size(); ++i)
      if (way[i].means)
        (way[i].period ? periodic : open).add(response.axis.value(std::int64_t(i)), way[i].means->amplitude);
  };
  for (const Sweep& sweep : response.sweeps) {
    add(sweep.up, panel.rising, panel.rising_open);
    add(sweep.down, panel.falling, panel.falling_open);
  }
}

// Adds each piece of a branch that is stable, or not, from the last point of the previous piece. Of points
// too close to be distinguished, as where an impact passes phase 0 of the force, the first is kept.
void add_branches(Panel& panel, const OrbitsResponse& response) {
  const double close = 1e-3 * (response.range.most() - response.range.least());
  const auto is_close = [&](const OrbitPoint& a, const OrbitPoint& b) {
    return std::abs(a.value - b.value) < close && std::abs(a.amplitude - b.amplitude) < 5e-3 * b.amplitude;
  };
  for (const OrbitBranch& branch : response.branches) {
    const OrbitPoint *before = nullptr, *kept = nullptr;
    for (std::size_t i = 0; i < branch.points.size(); ++i) {
      const OrbitPoint& point = branch.points[i];
      if (point.impacts == ImpactCounts{}) {  // the motion of the empty box
        before = nullptr;
        continue;
      }
      Points& piece = point.stable ? panel.stable : panel.unstable;
      const bool begins = !before || before->stable != point.stable,
                 ends = i + 1 == branch.points.size() || branch.points[i + 1].stable != point.stable;
      if (begins) {
        piece.interrupt();
        if (before) piece.add(before->value, before->amplitude);
      }
      if (begins || ends || !is_close(*kept, point)) {
        piece.add(point.value, point.amplitude);
        kept = &point;
      }
      before = &point;
    }
  }
}

// Returns the response as one of a kind, which `wanted` names.
template <class Kind>
const Kind& as(const Figure& figure, const FigureResponse& source) {
  const auto* const response = std::get_if<Kind>(&source.response);
  if (!response)
    throw unusable(figure, source.file,
                   "must be a " + std::string(Kind::kind) + ", got " + std::string(kind_of(source.response)));
  return *response;
}

}  // namespace

const Scene& scene_of(const Response& response) {
  return std::visit([](const auto& each) -> const Scene& { return each.scene; }, response);
}

void add_response_blocks(const Figure& figure, const std::vector<const FigureResponse*>& sources,
                         Table& table) {
  std::vector<Panel> panels;
  for (const FigureResponse* source : sources) {
    const Scene& scene = scene_of(source->response);
    const auto known = std::ranges::find(panels, scene.force_amplitude, &Panel::force);
    if (const auto* const orbits = std::get_if<OrbitsResponse>(&source->response);
        orbits && known != panels.end()) {
      add_branches(*known, *orbits);
      continue;
    }
    const SweepResponse& sweep = as<SweepResponse>(figure, *source);
    if (known != panels.end()) {
      add_ways(*known, sweep);
      continue;
    }
    panels.emplace_back().force = scene.force_amplitude;
    add_ways(panels.back(), sweep);
    const std::string panel = std::to_string(panels.size());
    const double force = scene.force_amplitude / scene.damper().mass_ratio;
    table.add({.name = "panel-" + panel,
               .columns = {{"force", of_force, {force}},
                           {"f₀ = " + rounded_text(force, 3) + " ν", of_force, {force}}}});
    add_linear_block(table, "empty-" + panel, "without the secondary mass", scene, sweep.axis, 1);
    add_linear_block(table, "locked-" + panel, "secondary mass locked", scene, sweep.axis,
                     1 + scene.damper().mass_ratio);
    constexpr double largest_drawn = 5;
    if (scene.damper().restitution == 0 && scene.damping_ratio == 0)
      add_plastic_block(table, "plastic-" + panel, scene, sweep.axis, largest_drawn);
  }
  for (std::size_t i = 0; i < panels.size(); ++i) {
    const Panel& panel = panels[i];
    const auto add = [&](const char* name, const char* legend, const Points& points) {
      add_block(table, name + std::to_string(i + 1), of_frequency, legend, of_amplitude, points);
    };
    add("rising-", "frequency rising", panel.rising);
    add("falling-", "frequency falling", panel.falling);
    add("rising-open-", "not periodic, rising", panel.rising_open);
    add("falling-open-", "not periodic, falling", panel.falling_open);
    add("stable-", "periodic, stable", panel.stable);
    add("unstable-", "periodic, unstable", panel.unstable);
  }
}

void add_largest_blocks(const Figure& figure, const FigureRun& decay,
                        const std::vector<const FigureResponse*>& sources, Table& table) {
  const double nu = decay.run.scene.damper().mass_ratio;
  std::vector<std::vector<const SweepResponse*>> along_the_same_forces;
  for (const FigureResponse* source : sources) {
    const SweepResponse& response = as<SweepResponse>(figure, *source);
    const auto same = std::ranges::find_if(along_the_same_forces, [&](const auto& each) {
      return each.front()->axis.values() == response.axis.values() &&
             each.front()->sweeps.size() == response.sweeps.size();
    });
    (same == along_the_same_forces.end() ? along_the_same_forces.emplace_back() : *same).push_back(&response);
  }
  Points rising, falling;
  for (const auto& responses : along_the_same_forces) {
    for (const auto& [way, points] : {std::pair(&Sweep::up, &rising), {&Sweep::down, &falling}})
      for (const Curve& curve : largest_amplitudes(responses, way))
        for (std::size_t i = 0; i < curve.x.size(); ++i)
          if (curve.y[i] > 0) points->add(curve.x[i] / nu, curve.y[i]);
  }

  // A eta of the decay, and of its ensemble: (M14.7) turns them into forces.
  Figure of_loss = figure;
  of_loss.ordinate = LossOrdinate::eta;
  Table losses;
  add_loss_block(of_loss, figure.curves[0], decay, "1", "", losses);
  const auto force_at = [&](double amplitude, double eta) {
    return square_root(1 + nu) * amplitude * eta / nu;
  };
  Points beyond, prediction, band;
  for (const TableBlock& block : losses.blocks) {
    const std::vector<double>& amplitude = block.columns[0].values;
    if (block.name == "curve-1") {
      std::vector<double> force;
      for (std::size_t i = 0; i < amplitude.size(); ++i)
        force.push_back(force_at(amplitude[i], block.columns[1].values[i]));
      // Without the first point: the release is among the peaks that it is fitted to.
      const auto most = std::size_t(std::max_element(force.begin() + 1, force.end()) - force.begin());
      for (std::size_t i = 1; i <= most; ++i) beyond.add(force[i], amplitude[i]);
      for (std::size_t i = most; i < force.size(); ++i) prediction.add(force[i], amplitude[i]);
    }
    if (block.name == "band-1") {
      for (std::size_t i = 0; i < amplitude.size(); ++i)
        band.add(force_at(amplitude[i], block.columns[1].values[i]), amplitude[i]);
      for (std::size_t i = amplitude.size(); i-- > 0;)
        band.add(force_at(amplitude[i], block.columns[2].values[i]), amplitude[i]);
    }
  }
  const std::string members = std::to_string(figure.curves[0].ensemble);
  add_block(table, "band", of_force, "range of the prediction over " + members + " releases", of_amplitude,
            band, {"the outline of what the ensemble of scene " + figure.curves[0].scene + " spans"});
  add_block(table, "prediction", of_force, "predicted by the free decay", of_amplitude, prediction,
            {"sqrt(1 + nu) A eta(A) / nu of scene " + figure.curves[0].scene + ", below its largest"});
  add_block(table, "beyond", of_force, "beyond the largest force", of_amplitude, beyond);
  add_block(table, "rising", of_force, "largest found, force rising", of_amplitude, rising,
            {"the largest of all frequencies, for each start"});
  add_block(table, "falling", of_force, "largest found, force falling", of_amplitude, falling,
            {"the largest of all frequencies, for each start"});
}

void add_map_blocks(const Figure& figure, const FigureResponse& source, Table& table) {
  const BasinResponse& response = as<BasinResponse>(figure, source);
  const double nu = response.scene.damper().mass_ratio;
  const Basin& basin = response.basin;
  // What a point of the map shows, in the order of the legend.
  enum Kind : std::size_t { symmetric, asymmetric, two, three, other, irregular, idle };
  constexpr std::array<std::pair<const char*, const char*>, 7> kinds{
      {{"one-symmetric", "one impact on each wall, symmetric"},
       {"one-asymmetric", "one on each wall, not symmetric"},
       {"each-2", "2 on each wall"},
       {"each-3", "3 on each wall"},
       {"other", "other periodic motions"},
       {"irregular", "nothing periodic found"},
       {"idle", "never struck"}}};
  const auto kind_at = [&](std::size_t i) {
    if (basin.attractor[i] == undecided) return irregular;
    const Attractor& each = basin.attractors[std::size_t(basin.attractor[i])];
    if (each.idle) return idle;
    if (each.period != 1 || each.impacts[0] != each.impacts[1]) return other;
    if (each.impacts[0] == 1) return each.symmetric ? symmetric : asymmetric;
    return each.impacts[0] == 2 ? two : each.impacts[0] == 3 ? three : other;
  };
  std::array<Points, kinds.size()> regimes;
  for (std::size_t i = 0; i < basin.attractor.size(); ++i) {
    const std::int64_t n = std::int64_t(i);
    regimes[kind_at(i)].add(response.first.value(n % response.first.count),
                            response.second.value(n / response.first.count) / nu);
  }
  const auto step = [](const Axis& axis) { return (axis.to - axis.from) / double(axis.count - 1); };
  table.add({.name = "cell",
             .notes = {"how far apart the points of the map are"},
             .columns = {{"width", of_frequency, {step(response.first)}},
                         {"height", of_force, {step(response.second) / nu}}}});
  for (std::size_t kind = 0; kind < kinds.size(); ++kind)
    add_block(table, kinds[kind].first, of_frequency, kinds[kind].second, of_force, regimes[kind]);
}

}  // namespace impact_damper
