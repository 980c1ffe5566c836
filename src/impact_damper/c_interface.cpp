#include "impact_damper/c_interface.h"

#include <algorithm>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <numeric>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "impact_damper/base/text.hpp"
#include "impact_damper/io/scene_file.hpp"
#include "impact_damper/simulate.hpp"

struct impact_damper_run {
  impact_damper::StopReason stop_reason = impact_damper::StopReason::time;
  std::map<std::string, std::vector<double>, std::less<>> columns;
};

namespace impact_damper {
namespace {

double as_double(double value) { return value; }
double as_double(std::int64_t value) { return static_cast<double>(value); }
double as_double(Wall wall) { return wall == Wall::left ? 0 : 1; }
double as_double(const std::optional<double>& value) {
  return value.value_or(std::numeric_limits<double>::quiet_NaN());
}

class Columns {
 public:
  explicit Columns(impact_damper_run& run) : run_(run) {}

  template <class Element>
  void add(const char* name, const std::vector<Element>& values) {
    std::vector<double> column;
    column.reserve(std::max<std::size_t>(values.size(), 1));  // so that an empty column, too, has an address
    for (const Element& value : values) column.push_back(as_double(value));
    run_.columns.emplace(name, std::move(column));
  }
  void add(const char* name, double value) { add(name, std::vector<double>{value}); }

 private:
  impact_damper_run& run_;
};

void add_energy(Columns& columns, const EnergyBalance& energy) {
  columns.add("energy/initial/kinetic", energy.initial.kinetic);
  columns.add("energy/initial/spring", energy.initial.spring);
  columns.add("energy/initial/wall", energy.initial.wall);
  columns.add("energy/initial/total", energy.initial.total());
  columns.add("energy/initial/paper", energy.initial.paper);
  columns.add("energy/final/kinetic", energy.final.kinetic);
  columns.add("energy/final/spring", energy.final.spring);
  columns.add("energy/final/wall", energy.final.wall);
  columns.add("energy/final/total", energy.final.total());
  columns.add("energy/final/paper", energy.final.paper);
  columns.add("energy/impact_loss", energy.impact_loss);
  columns.add("energy/impact_loss_total",
              std::accumulate(energy.impact_loss.begin(), energy.impact_loss.end(), 0.0));
  columns.add("energy/contact_loss", energy.contact_loss);
  columns.add("energy/bounce_downs", as_double(energy.bounce_downs));
  columns.add("energy/bounce_down_loss", energy.bounce_down_loss);
  columns.add("energy/viscous_work", energy.viscous_work);
  columns.add("energy/forcing_work", energy.forcing_work);
  columns.add("energy/residual", energy.residual);
}

Engine engine_of(std::string_view name) {
  const std::vector<std::string_view> names = engine_names();
  const auto found = std::ranges::find(names, name);
  if (found != names.end()) return default_engines()[static_cast<std::size_t>(found - names.begin())];
  throw std::invalid_argument("engine: must be " + listed(names, "or") + ", got " + std::string(name));
}

std::unique_ptr<impact_damper_run> run_of(const char* scene, const char* engine,
                                          const impact_damper_window* history) {
  if (scene == nullptr || engine == nullptr) throw std::invalid_argument("scene, engine: must not be NULL");
  Record record;
  record.impacts = record.contacts = record.energy = true;
  if (history != nullptr) {
    const auto count = std::min<std::size_t>(history->count, most_samples + 1);  // more are rejected, too
    record.history = {{history->begin, history->end, static_cast<std::int64_t>(count)}};
  }
  const Run run = simulate(parse_scene("scene", scene), engine_of(engine), record);

  auto result = std::make_unique<impact_damper_run>();
  result->stop_reason = run.stop_reason;
  Columns columns(*result);
  columns.add("end_time", run.end_time);
  columns.add("half_cycles/zero_crossing", run.half_cycles->zero_crossing);
  columns.add("half_cycles/peak_time", run.half_cycles->peak_time);
  columns.add("half_cycles/amplitude", run.half_cycles->amplitude);
  columns.add("half_cycles/impacts", run.half_cycles->impacts);
  columns.add("impacts/time", run.impacts->time);
  columns.add("impacts/wall", run.impacts->wall);
  columns.add("impacts/relative_velocity", run.impacts->relative_velocity);
  columns.add("impacts/phase_deg", run.impacts->phase_deg);
  columns.add("impacts/amplitude", run.impacts->amplitude);
  columns.add("impacts/displacement", run.impacts->displacement);
  columns.add("contacts/begin", run.contacts->begin);
  columns.add("contacts/end", run.contacts->end);
  columns.add("contacts/wall", run.contacts->wall);
  add_energy(columns, *run.energy);
  if (run.history) {
    columns.add("history/time", run.history->time);
    columns.add("history/x", run.history->x);
    columns.add("history/v", run.history->v);
    columns.add("history/y", run.history->y);
    columns.add("history/w", run.history->w);
  }
  return result;
}

}  // namespace
}  // namespace impact_damper

impact_damper_run* impact_damper_simulate(const char* scene, const char* engine,
                                          const impact_damper_window* history, char* error,
                                          size_t error_size) {
  // No exception may leave a function that C calls.
  try {
    return impact_damper::run_of(scene, engine, history).release();
  } catch (const std::exception& problem) {
    if (error_size > 0) {
      const std::string_view text = std::string_view(problem.what()).substr(0, error_size - 1);
      *std::copy(text.begin(), text.end(), error) = '\0';
    }
    return nullptr;
  }
}

const double* impact_damper_column(const impact_damper_run* run, const char* name, size_t* rows) {
  const auto found = run->columns.find(std::string_view(name));
  *rows = found == run->columns.end() ? 0 : found->second.size();
  return found == run->columns.end() ? nullptr : found->second.data();
}

const char* impact_damper_stop_reason(const impact_damper_run* run) {
  return impact_damper::name_of(run->stop_reason).data();  // of a literal, which '\0' ends
}

void impact_damper_free(impact_damper_run* run) { delete run; }
