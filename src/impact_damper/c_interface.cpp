#include "impact_damper/c_interface.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <list>
#include <memory>
#include <new>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "impact_damper/analysis/loss_factor.hpp"
#include "impact_damper/analysis/regimes.hpp"
#include "impact_damper/base/text.hpp"
#include "impact_damper/io/run_columns.hpp"
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

// Lists the columns of `all.run` in `all`, which must not be moved afterwards.
class Columns {
 public:
  explicit Columns(impact_damper_run& all) : all_(all) {}

  void add_all() {
    add("end_time", all_.run.end_time);
    if (all_.scales)
      for (const Dimension each : dimensions_in_files) add("units/" + key_of(each), all_.scales->in_si(each));
    add("", all_.run);
  }

 private:
  template <HasRunColumns Owner>
  void add(const std::string& above, const Owner& owner) {
    for_each_column(owner, shape_of(all_.run.scene), [&](const RunColumnInfo& info, const auto& value) {
      add((above.empty() ? "" : above + '/').append(info.name), value);
    });
  }
  template <HasRunColumns Section>
  void add(const std::string& name, const std::optional<Section>& section) {
    if (section) add(name, *section);
  }
  template <HasRunColumns Part>
  void add(const std::string& name, const std::vector<Part>& parts) {
    for (std::size_t i = 0; i < parts.size(); ++i) add(name + '/' + std::to_string(i + 1), parts[i]);
  }
  void add(const std::string& name, const std::vector<double>& values, bool stands_alone = false) {
    static constexpr double none = 0;  // so that an empty column, too, has an address
    all_.columns.push_back({name, values.empty() ? &none : values.data(), values.size(), stands_alone});
  }
  template <class Element>
  void add(const std::string& name, const std::vector<Element>& values) {
    std::vector<double>& column = all_.converted.emplace_back();
    column.reserve(values.size());
    for (const Element& value : values) column.push_back(as_double(in_file(value)));
    add(name, column);
  }
  void add(const std::string& name, double value) { add(name, all_.converted.emplace_back(1, value), true); }
  void add(const std::string& name, std::int64_t value) { add(name, as_double(value)); }

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
  const SceneFile file = parse_scene_file("scene", scene);
  auto result = std::make_unique<impact_damper_run>();
  result->run = simulate(file.scene, engine_of(engine), record);
  result->scales = file.scales;
  Columns(*result).add_all();
  return result;
}

void copy_message(const char* problem, char* error, std::size_t error_size) {
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
    impact_damper::copy_message(problem.what(), error, error_size);
    return IMPACT_DAMPER_NUMERICAL_FAILURE;
  } catch (const std::bad_alloc&) {
    impact_damper::copy_message("there is not enough memory for the run", error, error_size);
    return IMPACT_DAMPER_OUT_OF_MEMORY;
  } catch (const std::exception& problem) {
    impact_damper::copy_message(problem.what(), error, error_size);
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
    if (has_one_damper(run->run.scene))
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
