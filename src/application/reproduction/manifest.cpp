#include "application/reproduction/manifest.hpp"

#include <algorithm>

#include "impact_damper/engine.hpp"

namespace impact_damper {
namespace {

constexpr std::string_view dot = "\u00b7";
constexpr std::size_t stamped_digits = 8;

bool is_digit(char c) { return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f'); }

bool is_sum(std::string_view text) { return text.size() == 64 && std::ranges::all_of(text, is_digit); }

bool is_swhid(std::string_view text) {
  constexpr std::string_view content = "swh:1:cnt:";
  return text.starts_with(content) && text.size() == content.size() + 40 &&
         std::ranges::all_of(text.substr(content.size()), is_digit);
}

bool is_path(std::string_view text) {
  if (text.size() > 200) return false;
  for (;;) {
    const std::size_t slash = text.find('/');
    if (!a_name.allows(text.substr(0, slash))) return false;
    if (slash == std::string_view::npos) return true;
    text.remove_prefix(slash + 1);
  }
}

bool read_text_of(ObjectReader& object, std::string_view key, std::string& target,
                  bool (*allows)(std::string_view), const std::string& allowed) {
  if (!object.required(key, target, some_text)) return false;
  if (allows(target)) return true;
  object.reject(key, "must be " + allowed + ", got the string " + in_quotes(target));
  return false;
}

// Reads a cited file. False if its SHA-256 is not valid.
bool read_cited_file(ObjectReader object, CitedFile& file) {
  read_text_of(object, "file", file.file, is_path,
               "a path of names of letters, digits, '-', '_' and '.', the first of each a letter or digit, "
               "divided by '/', of up to 200 characters");
  if (object.has("swhid"))
    read_text_of(object, "swhid", file.swhid, is_swhid,
                 "\"swh:1:cnt:\" and 40 hexadecimal digits in lower case");
  return read_text_of(object, "sha256", file.sha256, is_sum, "64 hexadecimal digits in lower case");
}

void read_cited_figure(ObjectReader& item, CitedFigure& figure, const std::string& version) {
  item.required("title", figure.title, some_text);
  for (const ObjectReader& scene : item.required_objects("scenes", 100))
    read_cited_file(scene, figure.scenes.emplace_back());
  bool sums_are_read = !version.empty();
  const std::vector<std::string_view> engines = engine_names();
  for (ObjectReader table : item.required_objects("tables", engines.size())) {
    const std::string_view engine = engines[figure.tables.size()];
    CitedTable& read = figure.tables.emplace_back();
    read.engine = engine;
    const bool in_order = table.require("engine") && table.word("engine", {engine});
    sums_are_read = read_cited_file(table, read.content) && in_order && sums_are_read;
  }
  if (const auto csv = item.optional_object("csv")) read_cited_file(*csv, figure.csv.emplace());
  sums_are_read = read_cited_file(item.required_object("script"), figure.script) && sums_are_read;
  read_cited_file(item.required_object("picture"), figure.picture);
  item.required("claims", figure.claims, a_name, std::size_t{100});
  if (!item.required("stamp", figure.stamp, some_text) || !sums_are_read) return;
  const CitedFile& stamped = figure.tables.empty() ? figure.script : figure.tables[0].content;
  const std::string wanted =
      stamped.sha256.substr(0, stamped_digits) + ' ' + std::string(dot) + ' ' + version;
  if (figure.stamp != wanted)
    item.reject("stamp",
                "must be " + in_quotes(wanted) +
                    ", as the SHA-256 of its table (or its script, without a table) begins, got the string " +
                    in_quotes(figure.stamp));
}

Manifest read_cited(JsonDocument document) {
  ObjectReader root = document.root();
  root.word("schema", {"impact-damper/manifest/1"});
  root.require("schema");

  Manifest manifest;
  ObjectReader software = root.required_object("software");
  software.required("title", manifest.title, some_text);
  software.required("version", manifest.version, a_name);
  software.required("license", manifest.license, a_name);
  software.required("year", manifest.year, within(1000, 9999));
  if (software.required("authors", manifest.authors, some_text, std::size_t{1000}) &&
      manifest.authors.empty())
    software.reject("authors", "must name at least one, got none");
  ObjectReader paper = root.required_object("paper");
  paper.required("title", manifest.paper_title, some_text);
  paper.required("note", manifest.paper_note, some_text);

  for (ObjectReader item : root.required_objects("figures", 1000)) {
    CitedFigure figure;
    if (item.required("figure", figure.number, TextRule{1, 8, true}) &&
        std::ranges::count(manifest.figures, figure.number, &CitedFigure::number) > 0)
      item.reject("figure", "must be given once, got the string " + in_quotes(figure.number));
    read_cited_figure(item, figure, manifest.version);
    manifest.figures.push_back(figure);
  }
  document.finish();
  return manifest;
}

}  // namespace

Manifest read_manifest(const std::filesystem::path& file) {
  return read_cited(JsonDocument::read(file, manifest_kind));
}
Manifest parse_manifest(const std::string& name, const std::string& text) {
  return read_cited(JsonDocument::parse(name, text));
}

std::optional<Stamp> parse_stamp(std::string_view text) {
  const auto without_blanks = [&] {
    while (text.starts_with(' ')) text.remove_prefix(1);
  };
  while (text.ends_with(' ')) text.remove_suffix(1);
  without_blanks();
  Stamp stamp;
  for (; !text.empty(); text.remove_prefix(1)) {
    const char c = text.front();
    const char digit = c >= 'A' && c <= 'F' ? static_cast<char>(c - 'A' + 'a') : c;
    if (!is_digit(digit)) break;
    stamp.digits += digit;
  }
  if (stamp.digits.size() < stamped_digits || stamp.digits.size() > 64) return std::nullopt;
  if (text.empty()) return stamp;
  if (!text.starts_with(' ') && !text.starts_with(dot)) return std::nullopt;
  without_blanks();
  if (text.starts_with(dot)) text.remove_prefix(dot.size());
  without_blanks();
  if (text.empty()) return stamp;
  if (!a_name.allows(text)) return std::nullopt;
  stamp.version = text;
  return stamp;
}

std::vector<Stamped> find_stamped(const Manifest& manifest, std::string_view digits) {
  std::vector<Stamped> found;
  for (const CitedFigure& figure : manifest.figures) {
    if (figure.tables.empty() && figure.script.sha256.starts_with(digits))
      found.push_back({&figure, nullptr});
    for (const CitedTable& table : figure.tables) {
      if (table.content.sha256.starts_with(digits)) found.push_back({&figure, &table});
    }
  }
  return found;
}

}  // namespace impact_damper
