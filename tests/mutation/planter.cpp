#include "planter.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "application/reproduction/measures.hpp"
#include "application/reproduction/series.hpp"
#include "impact_damper/engine_options.hpp"
#include "impact_damper/io/run_columns.hpp"
#include "impact_damper/io/run_file.hpp"
#include "impact_damper/simulate.hpp"

using namespace impact_damper;

namespace planted {
namespace {

struct Change {
  std::string_view kind;

  bool is(std::string_view name) const { return kind == name; }
  void number(double& value) const {
    if (is("scaled")) value *= 1.01;
    if (is("negated") && value != 0) value = -value;
  }
  void operator()(double& value) const {
    if (is("filled") && value == 0) value = 1;
    number(value);
  }
  template <std::signed_integral Count>
  void operator()(Count& value) const {
    value = is("scaled") ? value + 1 : is("negated") ? -value : value;
  }
  void operator()(bool& value) const { value ^= is("scaled"); }
  template <class Word>
  requires std::is_enum_v<Word>
  void operator()(Word& value) const {
    if (is("scaled")) value = value == Word{} ? Word{1} : Word{};
  }
  template <class Value>
  void operator()(std::optional<Value>& value) const {
    if (value)
      (*this)(*value);
    else if (is("filled"))
      value = 90;
  }
  template <class Value>
  void operator()(std::vector<Value>& column) const {
    if (is("shifted") && !column.empty()) std::rotate(column.begin(), column.begin() + 1, column.end());
    for (Value& each : column) {
      if constexpr (std::is_same_v<Value, double>)
        number(each);
      else if constexpr (!of_damper<Value>)
        (*this)(each);
    }
  }
  // A list of what each damper has, as a column has a row: it is shifted only.
  template <class Value>
  static constexpr bool of_damper =
      std::is_same_v<Value, SceneDamper> || std::is_same_v<Value, DamperEnergy> ||
      std::is_same_v<Value, History::Damper> || std::is_same_v<Value, HalfCycles::Damper>;
  void operator()(nlohmann::json& value) const {
    if (value.is_array()) {
      if (is("shifted") && !value.empty()) std::rotate(value.begin(), value.begin() + 1, value.end());
      for (auto& each : value)
        if (!each.is_object() && !(is("filled") && each == 0)) (*this)(each);
    } else if (value.is_boolean()) {
      value = value.get<bool>() != is("scaled");
    } else if (value.is_string() && is("scaled")) {
      value = value.get<std::string>() + "?";
    } else if (value.is_number_integer()) {
      // Written without a point, it may still be a fraction that happens to be whole.
      if (is("filled") && value == 0) value = 1;
      if (is("scaled")) value = value.get<std::int64_t>() + 1;
      if (is("negated")) value = -value.get<std::int64_t>();
    } else if (value.is_number()) {
      (*this)(value.get_ref<double&>());
    } else if (value.is_null() && is("filled")) {
      value = 90;
    }
  }
};

// The entries of a list of what each damper has: the list, and what the first one has.
template <class Value, class Visit, class Entries>
void each_damper(std::vector<Value>& dampers, Visit all, Entries entries) {
  if (dampers.empty()) return;
  all("dampers", dampers);
  entries(dampers.front(),
          [&](std::string_view name, auto& member) { all("dampers.1." + std::string(name), member); });
}

// What the table of columns has of `owner`, `above` before each name, but for sums, which a run does not
// keep.
template <class Owner, class Visit>
void each_column(Owner& owner, const std::string& above, const RunShape& shape, const Visit& all) {
  for_each_column(owner, shape, [&](const RunColumnInfo& info, auto&& value) {
    using Value = std::remove_reference_t<decltype(value)>;
    const std::string name = above + std::string(info.name);
    if constexpr (HasRunColumns<Value>) {
      each_column(value, name + '.', shape, all);
    } else if constexpr (PartsOfDampers<Value>) {
      all(name, value);
      if (!value.empty()) each_column(value.front(), name + ".1.", shape, all);
    } else if constexpr (std::is_lvalue_reference_v<decltype(value)>) {
      all(name, value);
    }
  });
}

// Every entry of a run, under its key in the run file: outputs.cpp holds this list against the file's own
// keys.
template <class Visit>
void each_entry(Run& run, Visit all) {
  const auto under = [&](std::string section) {
    return [&all, section](std::string_view name, auto& member) {
      all(section + '.' + std::string(name), member);
    };
  };
  all("stop_reason", run.stop_reason);
  all("end_time", run.end_time);
  const auto scene = under("scene"), engine = under("engine");
  const bool one = has_one_damper(run.scene);
  for (const SceneField& field : scene_fields)
    if ((one || field.number.own) && !field.is_absent(field.number.in(run.scene)))
      scene(field.name, field.number.in(run.scene));
  if (!one)
    each_damper(run.scene.dampers, scene, [](SceneDamper& damper, auto visit) {
      for (const SceneField& field : scene_damper_fields)
        if (!field.is_absent(damper.*field.number.of_damper))
          visit(field.name, damper.*field.number.of_damper);
    });
  scene("until_time", run.scene.until_time);
  scene("until_amplitude", run.scene.until_amplitude);
  for_each_option(run.engine, [&](const OptionInfo& option, auto& value) { engine(option.name, value); });
  for_each_column(run, shape_of(run.scene), [&](const RunColumnInfo& info, auto& section) {
    if (section) each_column(*section, std::string(info.name) + '.', shape_of(run.scene), all);
  });
}

}  // namespace

bool alter(Run& run, std::string_view output, std::string_view kind) {
  bool found = false;
  each_entry(run, [&](std::string_view name, auto& member) {
    if (name != output) return;
    found = true;
    Change{kind}(member);
  });
  return found;
}

// Behind the value that begins at `begin`.
std::size_t end_of_value(const std::string& text, std::size_t begin) {
  if (text[begin] == '"') return text.find('"', begin + 1) + 1;
  if (text[begin] != '[') return text.find_first_of(",}\n", begin);
  int open = 0;
  std::size_t end = begin;
  do {
    open += text[end] == '[' ? 1 : text[end] == ']' ? -1 : 0;
    ++end;
  } while (open > 0);
  return end;
}

bool alter(std::string& text, std::string_view output, std::string_view kind) {
  std::size_t begin = 0;
  for (std::size_t dot; !output.empty(); output.remove_prefix(std::min(dot, output.size() - 1) + 1)) {
    dot = output.find('.');
    const std::string_view name = output.substr(0, dot);
    if (name == "1") continue;  // the first of a list begins where the list does
    const std::string_view rest = dot == output.npos ? "" : output.substr(dot + 1);
    const std::string key = '"' + std::string(name) + "\": ";
    begin = text.find(key + (rest.empty() ? "" : rest.starts_with("1.") ? "[" : "{"), begin);
    if (begin == text.npos) return false;
    begin += key.size();
  }
  const std::size_t end = end_of_value(text, begin);
  auto value = nlohmann::json::parse(text.substr(begin, end - begin));
  const auto before = value;
  Change{kind}(value);
  if (value != before) text.replace(begin, end - begin, value.dump());
  return true;
}

bool alter(Table& table, std::string_view output, std::string_view kind) {
  bool found = false;
  for (TableBlock& block : table.blocks)
    for (std::size_t c = 0; c < block.columns.size(); ++c)
      if (output == family(block.name) + '.' + std::to_string(c + 1)) {
        found = true;
        Change{kind}(block.columns[c].values);
      }
  return found;
}

bool alter(Spread& spread, std::string_view output, std::string_view kind) {
  for (auto [name, value] :
       {std::pair{"median", &spread.median}, {"low", &spread.low}, {"high", &spread.high}}) {
    if (name != output) continue;
    const double before = *value;
    Change{kind}(*value);
    if (std::abs(*value - before) < 1e-9) *value += 1e-9;
    return true;
  }
  return false;
}

std::string kind_of_table(const Figure& figure) {
  return std::string(name_of(figure.table)) +
         (figure.ordinate ? '-' + std::string(name_of(*figure.ordinate)) : "");
}

std::string family(std::string block) { return block.substr(0, block.find_last_not_of("-0123456789") + 1); }

namespace {

struct Fault {
  std::string where, output, kind;
};

const Fault& fault() {
  static const Fault planted = [] {
    const char* const variable = std::getenv("PLANTED_FAULT");
    const std::string text = variable ? variable : "";
    const std::size_t first = text.find('/'), last = text.rfind('/');
    if (first == last) return Fault{};
    return Fault{text.substr(0, first), text.substr(first + 1, last - first - 1), text.substr(last + 1)};
  }();
  return planted;
}

template <class Result>
Result with_fault(std::string_view where, Result result, const std::string& above = {}) {
  const auto& [place, output, kind] = fault();
  if (place == where && output.starts_with(above))
    alter(result, std::string_view(output).substr(above.size()), kind);
  return result;
}

}  // namespace

// The linker leads every call of a function F to "__wrap_F", and what is called "__real_F" to F itself. The
// symbols' names are in CMakeLists.txt.
#define WRAPPED(RESULT, NAME, SYMBOL, ...)                     \
  RESULT real_##NAME(__VA_ARGS__) asm("__real_" SYMBOL);       \
  RESULT with_fault_##NAME(__VA_ARGS__) asm("__wrap_" SYMBOL); \
  RESULT with_fault_##NAME(__VA_ARGS__)

WRAPPED(Run, simulate, SIMULATE, const Scene& scene, const Engine& engine, const Record& record) {
  return with_fault(std::string(name_of(engine)) + (has_one_damper(scene) ? "" : "-dampers"),
                    real_simulate(scene, engine, record));
}
WRAPPED(std::string, run_text, RUN_TEXT, const Run& run, const std::optional<Scales>& scales) {
  return with_fault("file", real_run_text(run, scales));
}
WRAPPED(Run, read_run, READ_RUN, const std::filesystem::path& file) {
  return with_fault("read", real_read_run(file));
}
WRAPPED(Run, parse_run, PARSE_RUN, const std::string& name, const std::string& text) {
  return with_fault("read", real_parse_run(name, text));
}
WRAPPED(Table, figure_table, FIGURE_TABLE, const Figure& figure, const FigureRuns& runs,
        const FigureResponses& responses, const FigureSweeps& sweeps) {
  return with_fault("table", real_figure_table(figure, runs, responses, sweeps), kind_of_table(figure) + '.');
}
WRAPPED(Spread, measure, MEASURE, Runs& runs, const MeasureCall& call) {
  return with_fault("measure", real_measure(runs, call), call.name + '.');
}

}  // namespace planted
