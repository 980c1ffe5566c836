// `cite`: prints references to the program, and what a figure was made from, given the figure or its stamp.
#include <algorithm>
#include <filesystem>

#include "application/reproduction/manifest.hpp"
#include "commands.hpp"
#include "impact_damper/engine.hpp"
#include "impact_damper/io/json_reader.hpp"
#include "impact_damper/io/provenance.hpp"

namespace impact_damper::cli {
namespace {

// Returns a text in braces of its own, in which it is no list of names and keeps its capitals. Each is a
// value or part of one.
std::string braced(std::string_view text) {
  std::string value;
  for (const char c : text) {
    if (std::string_view("&%$#_{}").find(c) != std::string_view::npos) value += '\\';
    value += c == '~'    ? "\\textasciitilde{}"
             : c == '^'  ? "\\textasciicircum{}"
             : c == '\\' ? "\\textbackslash{}"
                         : std::string(1, c);
  }
  return '{' + value + '}';
}

// Returns a comment: BibTeX ignores what is between entries, except an @.
std::string comment(std::string_view text) {
  std::string line = "% " + std::string(text);
  std::ranges::replace(line, '@', '?');
  return line + '\n';
}

// Returns an identifier of Software Heritage, which TeX may break before its digits. It contains git's own
// hash.
std::string set_swhid(std::string_view swhid) {
  const std::size_t digits = swhid.rfind(':') + 1;
  return "\\texttt{" + std::string(swhid.substr(0, digits)) + "\\allowbreak{}" +
         std::string(swhid.substr(digits)) + '}';
}

// Returns one entry, in fields that every style of BibTeX prints; `note` is TeX. The commit and its tree are
// this program's: they are not known for another version's manifest, nor for a program built from modified
// sources.
std::string entry(const Manifest& manifest, const std::string& note) {
  std::vector<std::string> authors;
  for (const std::string& author : manifest.authors) authors.push_back(braced(author));
  std::string published = "Software, version " + manifest.version;
  if (provenance().version == manifest.version && !provenance().tree.empty())
    published += ", commit " + std::string(provenance().commit) + ", " +
                 set_swhid("swh:1:dir:" + std::string(provenance().tree));
  return filled(R"(@misc{impact-damper-{},
  author = {{}},
  title = {{}},
  howpublished = {{}},
  year = {{}}{}
}
)",
                manifest.version, joined(authors, " and "), braced(manifest.title), published, manifest.year,
                note.empty() ? "" : ",\n  note = {" + note + "}");
}

// Returns a label beside its values, of which there may be several.
std::string labelled(std::string_view label, const std::vector<std::string>& values) {
  std::string lines;
  for (const std::string& value : values) {
    std::string line = "  " + std::string(lines.empty() ? label : "");
    line.resize(11, ' ');
    lines += comment(line += value);
  }
  return lines;
}

std::string stamp_of(const Stamped& stamped) {
  const auto& [figure, table] = stamped;
  return (table ? table->content.sha256 : figure->script.sha256).substr(0, 8) + figure->stamp.substr(8);
}

std::string made_from(const Manifest& manifest, const Stamped& stamped) {
  const CitedFigure& figure = *stamped.figure;
  const CitedTable* const table = stamped.table;
  std::vector<std::string> scenes;
  for (const CitedFile& scene : figure.scenes) scenes.push_back(scene.file);
  const std::string picture = std::filesystem::path(figure.picture.file).filename().string();
  std::string shown = figure.picture.file, target = "figures/" + picture;
  if (table && table != figure.tables.data()) {  // another engine's, which is not published
    target = "figures/" + table->engine + "/" + picture;
    shown = "build/" + target;
  }

  std::string text = comment(
      filled("Figure {} of {} {}: {}", figure.number, manifest.title, manifest.version, figure.title));
  text += labelled("stamp", {stamp_of(stamped)});
  text += labelled("picture", {shown});
  if (table) text += labelled("table", {table->content.file, "by the " + table->engine + " engine"});
  if (figure.csv && table == figure.tables.data()) text += labelled("as CSV", {figure.csv->file});
  text += labelled("script", {figure.script.file});
  text += labelled(
      "SHA-256", {table ? table->content.sha256 + " of the table" : figure.script.sha256 + " of the script"});
  text += labelled("scenes", scenes);
  text += labelled("claims", figure.claims);
  text += labelled("made by", {"cmake --preset release", "cmake --build build --target " + target});
  return text;
}

// Returns why no figure here carries a stamp: where it may come from.
std::string why_not(const Manifest& manifest, const Stamp& stamp, const std::string& file) {
  std::vector<std::string_view> known;
  for (const CitedFigure& figure : manifest.figures) {
    if (figure.tables.empty()) known.push_back(std::string_view(figure.script.sha256).substr(0, 8));
    for (const CitedTable& table : figure.tables)
      known.push_back(std::string_view(table.content.sha256).substr(0, 8));
  }
  const bool of_another = stamp.version && *stamp.version != manifest.version;
  return filled("must be on a figure of {}, which is of version {} ({}), got {}{}{}", file, manifest.version,
                of_another ? filled("version {} has a manifest of its own", *stamp.version)
                           : "what was drawn from other data, such as one's own scene, is in none",
                in_quotes(stamp.digits), of_another ? " of version " + *stamp.version : "",
                did_you_mean(stamp.digits, known));
}

// Returns a manifest without figures: program and paper by paper/facts.json as it was when the program was
// built.
Manifest built_in() {
  JsonDocument document = JsonDocument::parse("paper/facts.json", std::string(embedded_text("facts.json")));
  ObjectReader root = document.root(), paper = root.required_object("paper");
  Manifest manifest;
  manifest.version = provenance().version;
  root.required("title", manifest.title, some_text);
  root.required("year", manifest.year);
  root.required("authors", manifest.authors, some_text, std::size_t{1000});
  paper.required("title", manifest.paper_title, some_text);
  paper.required("note", manifest.paper_note, some_text);
  return manifest;
}

int cite(Arguments& arguments) {
  const std::string file =
      arguments.file("--manifest").value_or(project_file("data/reference/manifest.json"));
  const std::optional<std::string> typed = arguments.text("--stamp");
  if (arguments.given("--figure") && typed)
    arguments.reject("--stamp", "must be given without --figure, got both");
  const std::optional<Stamp> stamp = typed ? parse_stamp(*typed) : std::nullopt;
  if (typed && !stamp)
    arguments.reject("--stamp",
                     "must be 8 to 64 hexadecimal digits, with or without a version behind them, such as "
                     "\"1a2b3c4d · 0.1.0\", got " +
                         in_quotes(*typed));
  arguments.finish();

  const bool of_a_figure = arguments.given("--figure") || stamp;
  const Manifest manifest = of_a_figure || arguments.given("--manifest") ? read_manifest(file) : built_in();
  const std::optional<std::size_t> number =
      arguments.word("--figure", texts_of(manifest.figures, &CitedFigure::number));
  std::vector<Stamped> figures;
  if (stamp) figures = find_stamped(manifest, stamp->digits);
  if (stamp && figures.empty()) arguments.reject("--stamp", why_not(manifest, *stamp, file));
  arguments.finish();
  if (number) {
    const CitedFigure& figure = manifest.figures[*number];
    figures.push_back({&figure, figure.tables.empty() ? nullptr : figure.tables.data()});
  }

  std::string text;
  if (const std::string_view version = provenance().version; version != manifest.version)
    text += comment(
        filled("The manifest {} is of version {}, this program of {}.", file, manifest.version, version));
  if (stamp && stamp->version && *stamp->version != manifest.version)
    text +=
        comment(filled("The stamp is of version {}: what it marks has the same bytes in {}, the rest of the "
                       "figure may have changed.",
                       *stamp->version, manifest.version));
  std::string note;
  for (const Stamped& each : figures) {
    text += made_from(manifest, each);
    const CitedFile& cited = each.table ? each.table->content : each.figure->script;
    note += (note.empty() ? "Figure " : "; figure ") + each.figure->number + ", stamp " +
            stamp_of(each).substr(0, 8);
    if (!cited.swhid.empty()) note += ", " + set_swhid(cited.swhid);
  }
  text += entry(manifest, note);
  write_standard_output(text);
  return 0;
}

}  // namespace

Command cite_command() {
  return {
      .name = "cite",
      .description = "Say how to cite the program, and what a figure was made from.",
      .options = {{"--figure", "NUMBER",
                   "what figure NUMBER of the manifest was made from, with which\ncommands"},
                  {"--stamp", "TEXT", "the same for the figure that carries this in its lower right corner"},
                  input_option("--manifest", "FILE",
                               "what the figures were made from; default data/reference/manifest.json")},
      .footer =
          R"(What is printed is one BibTeX entry with version, commit and the Software Heritage identifiers (SWHID) of the
source tree and of the table; what a figure was made from stands above it as a comment. A stamp consists of
the first digits of the SHA-256 of the table that is drawn (of the script if there is no table) and of the
version: it identifies the data, not the looks of the picture. --stamp finds the tables of this version, by
any engine.

Examples:
  impact-damper cite >> references.bib
  impact-damper cite --figure 8
  impact-damper cite --stamp "1a2b3c4d · 0.1.0")",
      .act = cite};
}

}  // namespace impact_damper::cli
