#include <concepts>
#include <stdexcept>
#include <type_traits>

#include "impact_damper/base/sha256.hpp"
#include "impact_damper/engine_options.hpp"
#include "impact_damper/io/csv.hpp"
#include "impact_damper/io/json_parts.hpp"
#include "impact_damper/io/provenance.hpp"
#include "impact_damper/io/run_columns.hpp"
#include "impact_damper/io/run_file.hpp"
#include "impact_damper/io/scene_file.hpp"

namespace impact_damper {
namespace {

using Layout = JsonWriter::Layout;

// Writes all that the table of columns has of `owner`.
template <class Owner>
void write_columns(JsonWriter& out, const Owner& owner, const RunShape& shape) {
  const auto finish_object = [&](const auto& part) {
    write_columns(out, part, shape);
    out.close();
  };
  for_each_column(owner, shape, [&](const RunColumnInfo& info, const auto& value) {
    using Value = std::remove_cvref_t<decltype(value)>;
    if constexpr (std::same_as<Owner, Run>) {
      if (!value) return;
      out.open_object(info.name, Layout::lines);
      finish_object(*value);
    } else if constexpr (HasRunColumns<Value>) {
      out.open_object(info.name, Layout::one_line);
      finish_object(value);
    } else if constexpr (PartsOfDampers<Value>) {
      out.open_array(info.name, Layout::lines);
      for (const auto& part : value) {
        out.open_object(Layout::one_line);
        finish_object(part);
      }
      out.close();
    } else {
      out.field(info.name, in_file(value));
    }
  });
}

// Adds the columns of a section, or of the part of it that one damper has.
template <class Owner>
void add_columns(CsvTable& table, const Owner& owner, const RunShape& shape,
                 const std::string& after_name = {}) {
  for_each_column(owner, shape, [&](const RunColumnInfo& info, const auto& value) {
    if constexpr (PartsOfDampers<std::remove_cvref_t<decltype(value)>>) {
      for (std::size_t i = 0; i < value.size(); ++i)
        add_columns(table, value[i], shape, '_' + std::to_string(i + 1));
    } else {
      table.add(std::string(info.name) + after_name, info.dimension, in_file(value));
    }
  });
}

}  // namespace

void write_engine(JsonWriter& out, const Engine& engine) {
  out.open_object("engine", Layout::one_line);
  out.field("name", name_of(engine));
  for_each_option(engine, [&]<class Value>(const OptionInfo& option, const Value& value) {
    if constexpr (std::is_same_v<Value, std::optional<double>>)
      if (!value && !option.in_every_file) return;
    out.field(option.name, value);
  });
  out.close();
}

void write_units(JsonWriter& out, const Scales& scales) {
  out.open_object("units", Layout::one_line);
  for (const Dimension each : dimensions_in_files) out.field(key_of(each), scales.in_si(each));
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
  out.fields("stop_reason", run.stop_reason, "end_time", run.end_time);
  if (scales) write_units(out, *scales);
  write_columns(out, run, shape_of(run.scene));
  write_provenance(out);
  return sealed(out.finish());
}

std::string run_csv(const Run& run, const std::optional<Scales>& scales) {
  CsvTable table("run", scales);
  for_each_column(run, shape_of(run.scene), [&]<class Section>(const RunColumnInfo&, const Section& section) {
    if constexpr (!std::same_as<Section, std::optional<EnergyBalance>>)  // energies are no table
      if (section && table.empty()) add_columns(table, *section, shape_of(run.scene));
  });
  if (table.empty())
    throw std::invalid_argument(
        "record: one of half_cycles, impacts, contacts and history is needed for CSV");
  return table.text();
}

}  // namespace impact_damper
