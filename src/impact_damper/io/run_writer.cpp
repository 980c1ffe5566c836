// Writes the text directly: a run may hold a million numbers, and the order of keys is part of the format.
#include <cmath>
#include <concepts>
#include <numeric>

#include "impact_damper/base/errors.hpp"
#include "impact_damper/base/number_text.hpp"
#include "impact_damper/base/sha256.hpp"
#include "impact_damper/engine_options.hpp"
#include "impact_damper/io/provenance.hpp"
#include "impact_damper/io/run_file.hpp"
#include "impact_damper/io/scene_file.hpp"

namespace impact_damper {
namespace {

class Writer {
 public:
  // An object's fields stand on lines of their own or all on one.
  enum class Layout { lines, one_line };

  void open(Layout layout) {
    text_ += '{';
    levels_.push_back({layout, true});
  }
  void open(std::string_view name, Layout layout) {
    key(name);
    open(layout);
  }
  void close() {
    const Layout layout = levels_.back().layout;
    levels_.pop_back();
    if (layout == Layout::lines) break_line();
    text_ += '}';
  }

  template <typename Value>
  void field(std::string_view name, const Value& given) {
    key(name);
    value(given);
  }
  template <typename Element>
  void field(std::string_view name, const std::vector<Element>& column) {
    key(name);
    text_ += '[';
    for (std::size_t i = 0; i < column.size(); ++i) {
      if (i > 0) text_ += ',';
      value(column[i]);
    }
    text_ += ']';
  }
  void json(std::string_view name, std::string_view value) {
    key(name);
    text_ += value;
  }

  std::string finish() { return std::move(text_); }

 private:
  struct Level {
    Layout layout;
    bool empty;
  };

  void key(std::string_view name) {
    Level& level = levels_.back();
    if (!level.empty) text_ += level.layout == Layout::lines ? "," : ", ";
    if (level.layout == Layout::lines) break_line();
    level.empty = false;
    text_ += '"';
    text_ += name;
    text_ += "\": ";
    name_ = name;
  }
  void break_line() {
    text_ += '\n';
    text_.append(levels_.size(), ' ');
  }

  void value(double number) {
    if (!std::isfinite(number)) {
      throw NumericalError("the run went astray: a number in its \"" + name_ + "\" is " +
                           number_text(number));
    }
    append_number(text_, number);
  }
  void value(const std::optional<double>& number) {
    if (number) {
      value(*number);
    } else {
      text_ += "null";
    }
  }
  void value(std::int64_t number) { append_number(text_, number); }
  void value(Wall wall) { text_ += wall == Wall::left ? '0' : '1'; }
  void value(std::same_as<bool> auto flag) { text_ += flag ? "true" : "false"; }
  void value(std::string_view word) {
    text_ += '"';
    for (const char c : word) {
      if (c == '"' || c == '\\') text_ += '\\';
      text_ += c;
    }
    text_ += '"';
  }

  std::string text_;
  std::string name_;  // of the field being written, for messages
  std::vector<Level> levels_;
};

using Layout = Writer::Layout;

template <class Value>
void write_option(Writer& out, const OptionInfo& option, const Value& value) {
  if constexpr (std::is_enum_v<Value>) {
    out.field(option.name, name_of(value));
  } else {
    if constexpr (std::is_same_v<Value, std::optional<double>>)
      if (!value && !option.in_every_file) return;
    out.field(option.name, value);
  }
}

void write(Writer& out, const Engine& engine) {
  out.open("engine", Layout::one_line);
  out.field("name", name_of(engine));
  for_each_option(engine,
                  [&](const OptionInfo& option, const auto& value) { write_option(out, option, value); });
  out.close();
}

void write(Writer& out, const HalfCycles& half_cycles) {
  out.open("half_cycles", Layout::lines);
  out.field("zero_crossing", half_cycles.zero_crossing);
  out.field("peak_time", half_cycles.peak_time);
  out.field("amplitude", half_cycles.amplitude);
  out.field("impacts", half_cycles.impacts);
  out.close();
}

void write(Writer& out, const Impacts& impacts) {
  out.open("impacts", Layout::lines);
  out.field("time", impacts.time);
  out.field("wall", impacts.wall);
  out.field("relative_velocity", impacts.relative_velocity);
  out.field("phase_deg", impacts.phase_deg);
  out.field("amplitude", impacts.amplitude);
  out.field("displacement", impacts.displacement);
  out.close();
}

void write(Writer& out, const Contacts& contacts) {
  out.open("contacts", Layout::lines);
  out.field("begin", contacts.begin);
  out.field("end", contacts.end);
  out.field("wall", contacts.wall);
  out.close();
}

void write(Writer& out, std::string_view name, const Energy& energy) {
  out.open(name, Layout::one_line);
  out.field("kinetic", energy.kinetic);
  out.field("spring", energy.spring);
  out.field("wall", energy.wall);
  out.field("total", energy.total());
  out.field("paper", energy.paper);
  out.close();
}

void write(Writer& out, const EnergyBalance& balance) {
  out.open("energy", Layout::lines);
  write(out, "initial", balance.initial);
  write(out, "final", balance.final);
  out.field("impact_loss", balance.impact_loss);
  out.field("impact_loss_total",
            std::accumulate(balance.impact_loss.begin(), balance.impact_loss.end(), 0.0));
  out.field("contact_loss", balance.contact_loss);
  out.field("bounce_downs", balance.bounce_downs);
  out.field("bounce_down_loss", balance.bounce_down_loss);
  out.field("viscous_work", balance.viscous_work);
  out.field("forcing_work", balance.forcing_work);
  out.field("residual", balance.residual);
  out.close();
}

void write(Writer& out, const History& history) {
  out.open("history", Layout::lines);
  out.field("time", history.time);
  out.field("x", history.x);
  out.field("v", history.v);
  out.field("y", history.y);
  out.field("w", history.w);
  out.close();
}

void write(Writer& out, const SiUnits& units) {
  out.open("units", Layout::one_line);
  for (const SiUnit& unit : si_units) out.field(unit.name, units.*unit.member);
  out.close();
}

void write(Writer& out, const Provenance& made_by) {
  out.open("provenance", Layout::one_line);
  out.field("version", made_by.version);
  out.field("commit", made_by.commit);
  out.field("compiler", made_by.compiler);
  out.field("build_type", made_by.build_type);
  out.field("flags", made_by.flags);
  out.field("system", made_by.system);
}

}  // namespace

std::string sealed(std::string text) {
  const std::string digest = sha256(text);
  return std::move(text) + std::string(seal_begin) + digest + std::string(seal_end);
}

std::string run_text(const Run& run, const std::optional<Scales>& scales) {
  Writer out;
  out.open(Layout::lines);
  out.field("schema", run_schema);
  out.json("scene", scene_text(run.scene));
  write(out, run.engine);
  out.field("stop_reason", name_of(run.stop_reason));
  out.field("end_time", run.end_time);
  if (scales) write(out, si_units_of(*scales));
  if (run.half_cycles) write(out, *run.half_cycles);
  if (run.impacts) write(out, *run.impacts);
  if (run.contacts) write(out, *run.contacts);
  if (run.energy) write(out, *run.energy);
  if (run.history) write(out, *run.history);
  write(out, provenance());
  return sealed(out.finish());
}

}  // namespace impact_damper
