#include <numeric>

#include "impact_damper/base/sha256.hpp"
#include "impact_damper/engine_options.hpp"
#include "impact_damper/io/json_parts.hpp"
#include "impact_damper/io/provenance.hpp"
#include "impact_damper/io/run_file.hpp"
#include "impact_damper/io/scene_file.hpp"

namespace impact_damper {
namespace {

using Layout = JsonWriter::Layout;

std::vector<std::int64_t> numbers_of(const std::vector<Wall>& walls) {
  std::vector<std::int64_t> numbers;
  numbers.reserve(walls.size());
  for (const Wall wall : walls) numbers.push_back(wall == Wall::left ? 0 : 1);
  return numbers;
}

// Dampers are numbered from 0 in memory.
std::vector<std::int64_t> from_one(const std::vector<std::int32_t>& dampers) {
  std::vector<std::int64_t> numbers;
  numbers.reserve(dampers.size());
  for (const std::int32_t damper : dampers) numbers.push_back(std::int64_t{damper} + 1);
  return numbers;
}

// Writes what a section has for each of several dampers.
template <class Of, class Write>
void write_dampers(JsonWriter& out, const std::vector<Of>& dampers, const Write& write_fields) {
  if (dampers.empty()) return;
  out.open_array("dampers", Layout::lines);
  for (const Of& each : dampers) {
    out.open_object(Layout::one_line);
    write_fields(each);
    out.close();
  }
  out.close();
}

void write(JsonWriter& out, const HalfCycles& half_cycles) {
  out.open_object("half_cycles", Layout::lines);
  out.fields("zero_crossing", half_cycles.zero_crossing, "peak_time", half_cycles.peak_time, "amplitude",
             half_cycles.amplitude, "impacts", half_cycles.impacts);
  write_dampers(out, half_cycles.impacts_by_damper,
                [&](const std::vector<std::int64_t>& impacts) { out.field("impacts", impacts); });
  out.close();
}

void write(JsonWriter& out, const Impacts& impacts, bool several) {
  out.open_object("impacts", Layout::lines);
  out.fields("time", impacts.time, "wall", numbers_of(impacts.wall), "relative_velocity",
             impacts.relative_velocity, "phase_deg", impacts.phase_deg, "amplitude", impacts.amplitude,
             "displacement", impacts.displacement);
  if (several) out.field("damper", from_one(impacts.damper));
  out.close();
}

void write(JsonWriter& out, const Contacts& contacts, bool several) {
  out.open_object("contacts", Layout::lines);
  out.fields("begin", contacts.begin, "end", contacts.end, "wall", numbers_of(contacts.wall));
  if (several) out.field("damper", from_one(contacts.damper));
  out.close();
}

void write(JsonWriter& out, std::string_view name, const Energy& energy) {
  out.object(name, Layout::one_line, "kinetic", energy.kinetic, "spring", energy.spring, "wall", energy.wall,
             "total", energy.total(), "paper", energy.paper);
}

void write(JsonWriter& out, const EnergyBalance& balance) {
  out.open_object("energy", Layout::lines);
  write(out, "initial", balance.initial);
  write(out, "final", balance.final);
  const double total = std::accumulate(balance.impact_loss.begin(), balance.impact_loss.end(), 0.0);
  out.fields("impact_loss", balance.impact_loss, "impact_loss_total", total, "contact_loss",
             balance.contact_loss, "bounce_downs", balance.bounce_downs, "bounce_down_loss",
             balance.bounce_down_loss, "viscous_work", balance.viscous_work, "forcing_work",
             balance.forcing_work, "residual", balance.residual);
  write_dampers(out, balance.dampers, [&](const DamperEnergy& its) {
    for (const DamperEnergyField& field : damper_energy_fields) out.field(field.name, its.*field.member);
    out.field("bounce_downs", its.bounce_downs);
  });
  out.close();
}

void write(JsonWriter& out, const History& history) {
  out.open_object("history", Layout::lines);
  out.fields("time", history.time, "x", history.x, "v", history.v);
  if (history.dampers.empty()) out.fields("y", history.y, "w", history.w);
  write_dampers(out, history.dampers,
                [&](const History::Damper& its) { out.fields("y", its.y, "w", its.w); });
  out.close();
}

template <class Value>
void write_option(JsonWriter& out, const OptionInfo& option, const Value& value) {
  if constexpr (std::is_enum_v<Value>) {
    out.field(option.name, name_of(value));
  } else {
    if constexpr (std::is_same_v<Value, std::optional<double>>)
      if (!value && !option.in_every_file) return;
    out.field(option.name, value);
  }
}

}  // namespace

void write_engine(JsonWriter& out, const Engine& engine) {
  out.open_object("engine", Layout::one_line);
  out.field("name", name_of(engine));
  for_each_option(engine,
                  [&](const OptionInfo& option, const auto& value) { write_option(out, option, value); });
  out.close();
}

void write_units(JsonWriter& out, const SiUnits& units) {
  out.open_object("units", Layout::one_line);
  for (const SiUnit& unit : si_units) out.field(unit.name, units.*unit.member);
  out.close();
}

void write_provenance(JsonWriter& out) {
  const Provenance& made_by = provenance();
  out.open_object("provenance", Layout::one_line);
  out.fields("version", made_by.version, "commit", made_by.commit, "compiler", made_by.compiler, "build_type",
             made_by.build_type, "flags", made_by.flags, "system", made_by.system);
}

std::string sealed(std::string text) {
  const std::string digest = sha256(text);
  return std::move(text) + std::string(seal_begin) + digest + std::string(seal_end);
}

std::string run_text(const Run& run, const std::optional<Scales>& scales) {
  JsonWriter out("run");
  out.open_object(Layout::lines);
  out.field("schema", run_schema);
  out.open_object("scene", Layout::one_line);
  write_scene_fields(out, run.scene);
  out.close();
  write_engine(out, run.engine);
  out.field("stop_reason", name_of(run.stop_reason));
  out.field("end_time", run.end_time);
  if (scales) write_units(out, si_units_of(*scales));
  if (run.half_cycles) write(out, *run.half_cycles);
  const bool several = !run.scene.dampers.empty();  // a column without rows does not show it
  if (run.impacts) write(out, *run.impacts, several);
  if (run.contacts) write(out, *run.contacts, several);
  if (run.energy) write(out, *run.energy);
  if (run.history) write(out, *run.history);
  write_provenance(out);
  return sealed(out.finish());
}

}  // namespace impact_damper
