// The table of columns of a run against what else lists them: the schema of run files, and the types that the
// package for browsers and node declares.
#include "impact_damper/io/run_columns.hpp"

#include <doctest/doctest.h>

#include <limits>
#include <nlohmann/json.hpp>
#include <regex>
#include <string>
#include <type_traits>
#include <vector>

#include "impact_damper/io/json_reader.hpp"

using namespace impact_damper;

namespace {

using Json = nlohmann::ordered_json;

std::string source(const std::string& file) { return read_text(SOURCE_FOLDER "/" + file); }

// The schema's rule for a number.
Json rule_of(const NumberRange& range, const double&) {
  return {{"type", "number"}, {"minimum", range.least}, {"maximum", range.most}};
}
Json rule_of(const NumberRange& range, const std::optional<double>&) {
  return {{"type", {"number", "null"}}, {"minimum", range.least}, {"maximum", range.most}};
}
template <class Whole>
Json rule_of(const NumberRange& range, const Whole&) {
  const bool is_bounded = range.most < std::numeric_limits<double>::max();
  const auto most = is_bounded ? std::int64_t(range.most) : std::numeric_limits<std::int64_t>::max();
  return {{"type", "integer"}, {"minimum", range.least}, {"maximum", most}};
}

// The schema of a section or a part of one, without descriptions, and its additions for runs with a list of
// dampers and for those without.
struct Schema {
  Json whole, with_list, without_list;
};

template <class Owner>
Schema schema_of(const Json& type) {
  Schema schema;
  Json properties, required = Json::array(), of_list = Json::array();
  const Owner owner{};
  for_each_column(owner, true, [&](const RunColumnInfo& info, const auto& value) {
    using Value = std::remove_cvref_t<decltype(value)>;
    const std::string name(info.name);
    (info.without_list == WithoutList::same ? required : of_list).push_back(name);
    if constexpr (HasRunColumns<Value>) {
      properties[name] = schema_of<Value>("object").whole;
    } else if constexpr (PartsOfDampers<Value>) {
      const Json part = schema_of<typename Value::value_type>("object").whole;
      if (info.without_list == WithoutList::in_section) {
        properties.update(part["properties"]);
        schema.without_list["required"] = part["required"];
        for (const auto& column : part["properties"].items())
          schema.with_list["properties"][column.key()] = false;
      }
      properties[name] = {{"type", "array"}, {"items", part}};
    } else if constexpr (std::is_arithmetic_v<Value>) {
      properties[name] = rule_of(info.range, value);
    } else {
      properties[name] = {{"type", "array"}, {"items", rule_of(info.range, typename Value::value_type{})}};
    }
    if (info.without_list != WithoutList::same) schema.without_list["properties"][name] = false;
  });
  schema.whole = {
      {"type", type}, {"properties", properties}, {"required", required}, {"additionalProperties", false}};
  schema.with_list["required"] = of_list;
  return schema;
}

Json without_descriptions(Json schema) {
  if (schema.is_structured()) {
    if (schema.is_object()) schema.erase("description");
    for (Json& each : schema) each = without_descriptions(each);
  }
  return schema;
}

// Checks that the description of each column, or of what it is in, names its unit. above: of what it is in.
template <class Owner>
void units_are_named(const Json& schema, const std::string& above) {
  const auto words_of = [](Dimension dimension) {
    return dimension == Dimension::time       ? "1/Omega_n"
           : dimension == Dimension::length   ? "of epsilon"
           : dimension == Dimension::velocity ? "epsilon Omega_n"
                                              : "K epsilon\\^2";
  };
  const Owner owner{};
  for_each_column(owner, true, [&](const RunColumnInfo& info, const auto& value) {
    using Value = std::remove_cvref_t<decltype(value)>;
    const Json& its = schema.at("properties").at(std::string(info.name));
    const std::string text = above + its.at("description").get<std::string>();
    CAPTURE(text);
    if constexpr (HasRunColumns<Value>)
      units_are_named<Value>(its, text);
    else if constexpr (PartsOfDampers<Value>)
      units_are_named<typename Value::value_type>(its["items"], text);
    else if (info.dimension != Dimension::ratio)
      CHECK(std::regex_search(text, std::regex(std::string(words_of(info.dimension)) + "[.;]")));
  });
}

// What the package declares of a section: the columns and numbers that every run has.
template <class Section>
std::string type_of() {
  std::string columns, numbers;
  const Section section{};
  for_each_column(section, true, [&](const RunColumnInfo& info, const auto& value) {
    if (info.without_list != WithoutList::same || HasRunColumns<std::remove_cvref_t<decltype(value)>>) return;
    std::string& words = std::is_arithmetic_v<std::remove_cvref_t<decltype(value)>> ? numbers : columns;
    words.append(words.empty() ? "\"" : " | \"").append(info.name) += '"';
  });
  return "Columns & Record<" + columns + ", Float64Array>" +
         (numbers.empty() ? "" : " & Record<" + numbers + ", number>") + ";";
}

// Calls visit(name, section of its type) for each section.
template <class Visit>
void for_each_section(const Visit& visit) {
  const Run run{};
  for_each_column(run, true, [&]<class Section>(const RunColumnInfo& info, const std::optional<Section>&) {
    visit(std::string(info.name), Section{});
  });
}

}  // namespace

TEST_CASE("the schema of run files has the columns of the table, in its order, with their ranges and units") {
  const Json schema = Json::parse(source("data/schema/run.schema.json"));
  Json with_list, without_list;
  for_each_section([&]<class Section>(const std::string& name, const Section&) {
    CAPTURE(name);
    const Schema expected = schema_of<Section>({"object", "null"});
    const Json& given = schema["properties"][name];
    CHECK(without_descriptions(given) == expected.whole);
    units_are_named<Section>(given, given["description"]);
    with_list["properties"][name] = expected.with_list;
    without_list["properties"][name] = expected.without_list;
  });
  CHECK(nlohmann::json(schema["then"]) == nlohmann::json(with_list));
  CHECK(nlohmann::json(schema["else"]) == nlohmann::json(without_list));
}

TEST_CASE("the package for browsers and node declares the columns that every run has") {
  const std::string types =
      std::regex_replace(source("src/wasm/package/index.d.ts"), std::regex("\\s+"), " ");
  for_each_section([&]<class Section>(const std::string& name, const Section&) {
    const std::string expected = name + "?: " + type_of<Section>();
    CAPTURE(expected);
    CHECK(types.find(expected) != types.npos);
  });
}
