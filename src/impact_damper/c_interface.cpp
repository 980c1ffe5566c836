#include "impact_damper/c_interface.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <list>
#include <memory>
#include <new>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "impact_damper/analysis/loss_factor.hpp"
#include "impact_damper/analysis/regimes.hpp"
#include "impact_damper/base/text.hpp"
#include "impact_damper/io/run_file.hpp"
#include "impact_damper/io/scene_file.hpp"
#include "impact_damper/simulate.hpp"

namespace impact_damper {
namespace {

struct Column {
  std::string name;
  const double* values;  // never null
  std::size_t rows;
  bool stands_alone;
};

double as_double(std::int64_t value) { return static_cast<double>(value); }
double as_double(std::int32_t damper) { return damper + 1; }  // numbered from 1
double as_double(Wall wall) { return wall == Wall::left ? 0 : 1; }
double as_double(const std::optional<double>& value) {
  return value.value_or(std::numeric_limits<double>::quiet_NaN());
}

}  // namespace
}  // namespace impact_damper

struct impact_damper_run {
  impact_damper::Run run;
  std::optional<impact_damper::Scales> scales;
  std::vector<impact_damper::Column> columns;  // of `run` and of `converted`, in the order of a run file
  std::list<std::vector<double>>
      converted;  // columns that `run` does not have as doubles; a list, so that they stay in place
};

namespace impact_damper {
namespace {

// Lists the columns in `all`, which must not be moved afterwards.
class Columns {
 public:
  explicit Columns(impact_damper_run& all) : all_(all) {}

  void add_all() {
    const Run& run = all_.run;
    add("end_time", run.end_time);
    if (all_.scales) add(si_units_of(*all_.scales));
    if (run.half_cycles) add(*run.half_cycles);
    if (run.impacts) add(*run.impacts);
    if (run.contacts) add(*run.contacts);
    if (run.energy) add(*run.energy);
    if (run.history) add(*run.history);
  }

 private:
  void add(std::string name, const std::vector<double>& values, bool stands_alone = false) {
    static constexpr double none = 0;  // so that an empty column, too, has an address
    all_.columns.push_back(
        {std::move(name), values.empty() ? &none : values.data(), values.size(), stands_alone});
  }
  template <class Element>
  void add(std::string name, const std::vector<Element>& values) {
    std::vector<double>& column = all_.converted.emplace_back();
    column.reserve(values.size());
    for (const Element& value : values) column.push_back(as_double(value));
    add(std::move(name), column);
  }
  void add(std::string name, double value) {
    add(std::move(name), all_.converted.emplace_back(1, value), true);
  }

  void add(const SiUnits& units) {
    for (const SiUnit& unit : si_units) add("units/" + std::string(unit.name), units.*unit.member);
  }
  void add(const HalfCycles& half_cycles) {
    add("half_cycles/zero_crossing", half_cycles.zero_crossing);
    add("half_cycles/peak_time", half_cycles.peak_time);
    add("half_cycles/amplitude", half_cycles.amplitude);
    add("half_cycles/impacts", half_cycles.impacts);
    for_each_damper("half_cycles", half_cycles.impacts_by_damper,
                    [&](const std::string& name, const std::vector<std::int64_t>& impacts) {
                      add(name + "/impacts", impacts);
                    });
  }
  void add(const Impacts& impacts) {
    add("impacts/time", impacts.time);
    add("impacts/wall", impacts.wall);
    add("impacts/relative_velocity", impacts.relative_velocity);
    add("impacts/phase_deg", impacts.phase_deg);
    add("impacts/amplitude", impacts.amplitude);
    add("impacts/displacement", impacts.displacement);
    if (several()) add("impacts/damper", impacts.damper);
  }
  void add(const Contacts& contacts) {
    add("contacts/begin", contacts.begin);
    add("contacts/end", contacts.end);
    add("contacts/wall", contacts.wall);
    if (several()) add("contacts/damper", contacts.damper);
  }
  void add(const std::string& name, const Energy& energy) {
    add(name + "/kinetic", energy.kinetic);
    add(name + "/spring", energy.spring);
    add(name + "/wall", energy.wall);
    add(name + "/total", energy.total());
    add(name + "/paper", energy.paper);
  }
  void add(const EnergyBalance& energy) {
    add("energy/initial", energy.initial);
    add("energy/final", energy.final);
    add("energy/impact_loss", energy.impact_loss);
    add("energy/impact_loss_total",
        std::accumulate(energy.impact_loss.begin(), energy.impact_loss.end(), 0.0));
    add("energy/contact_loss", energy.contact_loss);
    add("energy/bounce_downs", as_double(energy.bounce_downs));
    add("energy/bounce_down_loss", energy.bounce_down_loss);
    add("energy/viscous_work", energy.viscous_work);
    add("energy/forcing_work", energy.forcing_work);
    add("energy/residual", energy.residual);
    for_each_damper("energy", energy.dampers, [&](const std::string& name, const DamperEnergy& its) {
      for (const DamperEnergyField& field : damper_energy_fields)
        add(name + '/' + std::string(field.name), its.*field.member);
      add(name + "/bounce_downs", as_double(its.bounce_downs));
    });
  }
  void add(const History& history) {
    add("history/time", history.time);
    add("history/x", history.x);
    add("history/v", history.v);
    if (!several()) {
      add("history/y", history.y);
      add("history/w", history.w);
    }
    for_each_damper("history", history.dampers, [&](const std::string& name, const History::Damper& its) {
      add(name + "/y", its.y);
      add(name + "/w", its.w);
    });
  }

  bool several() const { return !all_.run.scene.dampers.empty(); }
  // Calls add_columns(prefix of the names, damper) for each damper.
  template <class Of, class Add>
  static void for_each_damper(const std::string& section, const std::vector<Of>& dampers,
                              const Add& add_columns) {
    for (std::size_t i = 0; i < dampers.size(); ++i)
      add_columns(section + "/dampers/" + std::to_string(i + 1), dampers[i]);
  }

  impact_damper_run& all_;
};

Engine engine_of(const std::string& name) {
  if (name.starts_with('{')) return parse_engine("engine", name);
  const std::vector<std::string_view> names = engine_names();
  const auto found = std::ranges::find(names, name);
  if (found != names.end()) return default_engines()[static_cast<std::size_t>(found - names.begin())];
  throw std::invalid_argument("engine: must be " + listed(names, "or") + ", got " + name);
}

std::unique_ptr<impact_damper_run> run_of(const char* scene, const char* engine, unsigned recorded,
                                          const impact_damper_window* history) {
  if (scene == nullptr || engine == nullptr) throw std::invalid_argument("scene, engine: must not be NULL");
  Record record;
  record.impacts = (recorded & IMPACT_DAMPER_IMPACTS) != 0;
  record.contacts = (recorded & IMPACT_DAMPER_CONTACTS) != 0;
  record.energy = (recorded & IMPACT_DAMPER_ENERGY) != 0;
  if (history != nullptr) {
    const auto count = std::min<std::size_t>(history->count, most_samples + 1);  // more are rejected, too
    record.history = {{history->begin, history->end, static_cast<std::int64_t>(count)}};
  }
  const SceneFile file = parse_scene_file("scene", scene, DamperList::allowed);
  auto result = std::make_unique<impact_damper_run>();
  result->run = simulate(file.scene, engine_of(engine), record);
  result->scales = file.scales;
  Columns(*result).add_all();
  return result;
}

void tell(const char* problem, char* error, std::size_t error_size) {
  if (error_size == 0) return;
  const std::string_view text = std::string_view(problem).substr(0, error_size - 1);
  *std::copy(text.begin(), text.end(), error) = '\0';
}

}  // namespace
}  // namespace impact_damper

// No exception may leave a function that C calls.

impact_damper_status impact_damper_simulate(const char* scene, const char* engine,
                                            const impact_damper_window* history, impact_damper_run** run,
                                            char* error, size_t error_size) {
  return impact_damper_simulate_recording(
      scene, engine, IMPACT_DAMPER_IMPACTS | IMPACT_DAMPER_CONTACTS | IMPACT_DAMPER_ENERGY, history, run,
      error, error_size);
}

impact_damper_status impact_damper_simulate_recording(const char* scene, const char* engine, unsigned record,
                                                      const impact_damper_window* history,
                                                      impact_damper_run** run, char* error,
                                                      size_t error_size) {
  *run = nullptr;
  try {
    *run = impact_damper::run_of(scene, engine, record, history).release();
    return IMPACT_DAMPER_DONE;
  } catch (const impact_damper::NumericalError& problem) {
    impact_damper::tell(problem.what(), error, error_size);
    return IMPACT_DAMPER_NUMERICAL_FAILURE;
  } catch (const std::bad_alloc&) {
    impact_damper::tell("there is not enough memory for the run", error, error_size);
    return IMPACT_DAMPER_OUT_OF_MEMORY;
  } catch (const std::exception& problem) {
    impact_damper::tell(problem.what(), error, error_size);
    return IMPACT_DAMPER_INVALID;
  }
}

const double* impact_damper_column(const impact_damper_run* run, const char* name, size_t* rows) {
  const auto found = std::ranges::find(run->columns, std::string_view(name), &impact_damper::Column::name);
  const bool exists = found != run->columns.end();
  *rows = exists ? found->rows : 0;
  return exists ? found->values : nullptr;
}

const char* impact_damper_column_name(const impact_damper_run* run, size_t index, int* stands_alone) {
  if (index >= run->columns.size()) return nullptr;
  *stands_alone = run->columns[index].stands_alone ? 1 : 0;
  return run->columns[index].name.c_str();
}

const char* impact_damper_stop_reason(const impact_damper_run* run) {
  return impact_damper::name_of(run->run.stop_reason).data();  // of a literal, which '\0' ends
}

size_t impact_damper_loss_factor(const impact_damper_run* run, double* amplitude, double* time, double* eta) {
  try {
    const impact_damper::LossFactor loss = impact_damper::averaged_loss_factor(run->run.half_cycles.value());
    std::ranges::copy(loss.amplitude, amplitude);
    std::ranges::copy(loss.time, time);
    std::ranges::copy(loss.eta, eta);
    return loss.eta.size();
  } catch (const std::exception&) {
    return 0;
  }
}

double impact_damper_bounce_down_end(const impact_damper_run* run) {
  try {
    if (run->run.scene.dampers.empty())
      if (const auto end = impact_damper::end_of_bounce_down(run->run)) return end->amplitude;
  } catch (const std::exception&) {
    // Contacts were not recorded, or there was not enough memory.
  }
  return std::numeric_limits<double>::quiet_NaN();
}

char* impact_damper_run_text(const impact_damper_run* run) {
  try {
    return strdup(impact_damper::run_text(run->run, run->scales).c_str());
  } catch (const std::exception&) {
    return nullptr;
  }
}

void impact_damper_free(impact_damper_run* run) { delete run; }
