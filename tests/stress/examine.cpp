#include <algorithm>
#include <cmath>
#include <limits>

#include "impact_damper/analysis/consistency.hpp"
#include "impact_damper/io/scene_file.hpp"
#include "impact_damper/simulate.hpp"
#include "stress.hpp"

namespace stress {

using namespace impact_damper;

namespace {

constexpr double epsilon = std::numeric_limits<double>::epsilon();

void check_finite(const Run& run, std::string& broken) {
  const auto column = [&](const char* name, const std::vector<double>& values) {
    for (std::size_t i = 0; i < values.size(); ++i)
      if (!std::isfinite(values[i]) && broken.empty())
        broken = std::string(name) + "[" + std::to_string(i) + "] is " + full(values[i]);
  };
  column("end_time", {run.end_time});
  column("zero_crossing", run.half_cycles->zero_crossing);
  column("peak_time", run.half_cycles->peak_time);
  column("amplitude", run.half_cycles->amplitude);
  column("impact time", run.impacts->time);
  column("relative_velocity", run.impacts->relative_velocity);
  column("contact begin", run.contacts->begin);
  column("contact end", run.contacts->end);
  column("impact_loss", run.energy->impact_loss);
  column("history x", run.history->x);
  column("history v", run.history->v);
  for (const auto& damper : run.history->dampers) {
    column("history y of a damper", damper.y);
    column("history w of a damper", damper.w);
  }
  const EnergyBalance& balance = *run.energy;
  column("balance", {balance.initial.total(), balance.final.total(), balance.contact_loss,
                     balance.bounce_down_loss, balance.viscous_work, balance.forcing_work, balance.residual});
}

void check_consistency(const Run& run, std::string& broken) {
  const auto fault = [&](const std::string& what) {
    if (broken.empty()) broken = what;
  };
  const std::vector<double>& times = run.impacts->time;
  if (!std::ranges::is_sorted(times)) fault("impact before the one before it");
  for (const double loss : run.energy->impact_loss)
    if (!(loss >= 0)) fault("impact loss " + full(loss));
  for (const Problem& problem : inconsistencies_of(run)) fault(problem.field + " " + problem.message);
}

void check_bounds(const Run& run, std::string& broken) {
  if (run.stop_reason != StopReason::time && run.stop_reason != StopReason::impact_budget)
    broken = "stopped by " + std::string(name_of(run.stop_reason));
  // An impact that is found again and again where the state lies within rounding of a wall. (With e = 1
  // bounces too low for the last bit of time go on for ever.)
  const Impacts& impacts = *run.impacts;
  const std::size_t dampers = std::max<std::size_t>(1, run.scene.dampers.size());
  for (std::size_t n = 0; n < dampers; ++n) {
    if ((has_one_damper(run.scene) ? run.scene.damper().restitution : run.scene.dampers[n].restitution) == 1)
      continue;
    std::vector<std::size_t> rows;
    for (std::size_t i = 0; i < impacts.time.size(); ++i)
      if (impacts.damper.empty() || impacts.damper[i] == std::int32_t(n)) rows.push_back(i);
    for (std::size_t k = 3; k < rows.size(); ++k) {
      const std::size_t i = rows[k], j = rows[k - 3];
      if (impacts.wall[i] == impacts.wall[j] && impacts.time[i] - impacts.time[j] == 0 &&
          impacts.relative_velocity[i] == impacts.relative_velocity[j] && broken.empty())
        broken = "the same impact four times, at row " + std::to_string(i);
    }
  }
}

// How far y lies beyond its side of a wall, by the rounding of a straight flight less an oscillation. Within
// a rounding of a contact's ends, in time, either side will do.
void take_outside(const Run& run, std::size_t damper, double clearance, const std::vector<double>& y_of,
                  const std::vector<double>& w_of, Worst& worst) {
  const History& history = *run.history;
  const Contacts& contacts = *run.contacts;
  const bool rigid = std::holds_alternative<Restitution>(run.engine);
  std::vector<std::size_t> rows;
  for (std::size_t i = 0; i < contacts.begin.size(); ++i)
    if (contacts.damper.empty() || contacts.damper[i] == std::int32_t(damper)) rows.push_back(i);
  std::size_t next = 0;
  for (std::size_t i = 0; i < history.time.size(); ++i) {
    const double t = history.time[i], y = y_of[i], instant = 4 * epsilon * (1 + t);
    while (next < rows.size() && contacts.end[rows[next]] < t - instant) ++next;
    double beyond = std::max(-y, y - clearance);
    if (next < rows.size() && contacts.begin[rows[next]] <= t + instant) {
      const std::size_t row = rows[next];
      const double inwards = contacts.wall[row] == Wall::left ? -y : y - clearance;
      const bool inside = contacts.begin[row] < t - instant && t + instant < contacts.end[row];
      const double beyond_in_contact = rigid ? std::abs(inwards) : -inwards;
      beyond = inside ? beyond_in_contact : std::min(beyond, beyond_in_contact);
    }
    const double speed = std::abs(w_of[i]) + std::abs(history.v[i]) + std::abs(history.x[i]) +
                         run.scene.force_amplitude + std::max(1.0, clearance);
    worst.take(beyond / (epsilon * (1 + t) * speed));
  }
}
double outside(const Run& run) {
  Worst worst;
  const History& history = *run.history;
  if (has_one_damper(run.scene)) take_outside(run, 0, 1, history.dampers[0].y, history.dampers[0].w, worst);
  for (std::size_t n = 0; n < run.scene.dampers.size(); ++n)
    take_outside(run, n, run.scene.dampers[n].clearance, history.dampers[n].y, history.dampers[n].w, worst);
  return worst;
}

void check_end(const Run& run, std::string& broken) {
  if (!has_one_damper(run.scene)) return;             // which contact is whose inconsistencies_of() knows
  const double y = run.history->dampers[0].y.back();  // at the end, if the run came so far
  const bool cut = run.stop_reason == StopReason::time && (y < 0 || y > 1);
  if (cut && std::holds_alternative<Exact>(run.engine) && !run.contacts->end.empty() &&
      run.contacts->end.back() != run.end_time)
    broken =
        "the last contact ends " + rounded(run.contacts->end.back() - run.end_time) + " from the run's end";
}

}  // namespace

bool Examined::all_kept() const {
  for (const std::string& each : broken)
    if (!each.empty()) return false;
  return true;
}

Examined examine(const Scene& scene, const Engine& engine) {
  const double end = *scene.until_time;
  Record record;
  record.impacts = record.contacts = record.energy = true;
  double from = 0;
  for (const double part : {1e-6, 1e-3, 1e-1, 1.0}) {
    record.history.push_back({from, part * end, 8});
    from = part * end;
  }
  Examined result;
  const auto broken = [&](Promise promise) -> std::string& {
    return result.broken[static_cast<std::size_t>(promise)];
  };
  try {
    const Run run = simulate(scene, engine, record);
    check_finite(run, broken(Promise::finite));
    check_consistency(run, broken(Promise::consistent));
    check_bounds(run, broken(Promise::bounded));
    result.outside = outside(run);
    if (!(result.outside <= roundings_beyond_a_wall))
      broken(Promise::between_walls) = rounded(result.outside) + " roundings beyond a wall";
    check_end(run, broken(Promise::end_on_the_dot));
    result.residual = std::abs(run.energy->residual);
    if (!(result.residual <= closed_balance))
      broken(Promise::balance) = "open by " + rounded(result.residual);
  } catch (const std::exception& error) {
    broken(Promise::finite) = std::string("threw ") + error.what();
  }
  return result;
}

Examined keep_promises(Check& check, const std::string& which, const Scene& scene, const Engine& engine) {
  ++check.cases;
  const Examined examined = examine(scene, engine);
  for (std::size_t p = 0; p < promises.size(); ++p)
    if (!examined.broken[p].empty())
      check.miss(which + " " + promises[p] + ": " + examined.broken[p] + "; " + in_full(scene, engine));
  return examined;
}

std::string in_full(const Scene& scene) {
  std::string text = scene_text(scene);
  std::ranges::replace(text, '\n', ' ');
  return text;
}
std::string in_full(const Scene& scene, const Engine& engine) {
  return std::string(name_of(engine)) + "; " + in_full(scene);
}

double steps_from(double value, int ulps) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  for (; ulps > 0; --ulps) value = std::nextafter(value, infinity);
  for (; ulps < 0; ++ulps) value = std::nextafter(value, -infinity);
  return value;
}

double last_bit(double low, double high, const std::function<bool(double)>& predicate) {
  for (;;) {
    const double middle = low + (high - low) / 2;
    if (!(middle > std::min(low, high) && middle < std::max(low, high))) return high;
    (predicate(middle) ? high : low) = middle;
  }
}

}  // namespace stress
