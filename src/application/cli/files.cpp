#include "files.hpp"

#include <algorithm>
#include <array>
#include <system_error>

#include "application/reproduction/scene_runs.hpp"
#include "application/sweeps/sweep_table.hpp"
#include "progress.hpp"

namespace impact_damper::cli {

namespace fs = std::filesystem;

namespace {

struct FormatInfo {
  Format format;
  std::string_view title;
  std::vector<std::string_view> endings;
};

const FormatInfo& info_of(Format format) {
  static const std::vector<FormatInfo> all{
      {Format::json, "JSON", {".json"}},
      {Format::csv, "CSV", {".csv"}},
      {Format::gnuplot, "gnuplot", {".dat", ".txt"}},
      {Format::html, "HTML", {".html", ".htm"}},
      {Format::svg, "SVG", {".svg"}},
      {Format::markdown, "Markdown", {".md", ".markdown"}},
      {Format::hdf5, "HDF5", {hdf5_endings.begin(), hdf5_endings.end()}}};
  return *std::ranges::find(all, format, &FormatInfo::format);
}

bool is_ending_of(const std::string& ending, Format format) {
  return std::ranges::count(info_of(format).endings, std::string_view(ending)) > 0;
}

// Returns the ending in lower case, with its point; empty if there is none.
std::string ending_of(const std::string& file) {
  const std::string ending = in_lower_case(fs::path(file).extension().string());
  constexpr std::size_t longest = sizeof ".markdown" - 1;
  const bool is_one = ending.size() > 1 && ending.size() <= longest && ending[1] >= 'a' && ending[1] <= 'z';
  return is_one ? ending : "";
}

// Returns the number of characters, not bytes, of a text in UTF-8.
std::size_t width_of(const std::string& text) {
  return static_cast<std::size_t>(
      std::ranges::count_if(text, [](char c) { return (static_cast<unsigned char>(c) & 0xc0) != 0x80; }));
}

}  // namespace

std::string project_file(const std::string& name) {
  std::error_code none;
  if (fs::exists(name, none)) return name;
  const fs::path program = fs::read_symlink("/proc/self/exe", none);
  if (none) return name;
  const fs::path folder = program.parent_path();
  for (const fs::path& place :
       std::array{folder.parent_path() / "share/impact-damper", folder.parent_path().parent_path()}) {
    if (fs::exists(place / name, none)) return (place / name).string();
  }
  return name;
}

std::optional<std::string> find_named_file(const std::string& name) {
  std::error_code none;
  const std::string found = project_file(name);
  const bool is_of_project = name.starts_with("data/") || name.starts_with("figures/");
  return is_of_project && fs::exists(found, none) ? std::optional(found) : std::nullopt;
}

void add_ensemble(std::vector<fs::path>& files, const fs::path& run) {
  files.push_back(run);
  for (std::int64_t member = 2; member <= most_members; ++member) files.push_back(member_file(run, member));
}

std::string_view embedded_text(std::string_view name) {
  return std::ranges::find(embedded_files(), name, &EmbeddedFile::name)->text;
}

void reject_other_endings(Arguments& arguments, const std::string& option,
                          const std::optional<std::string>& output, std::initializer_list<Format> written) {
  const std::string ending = output ? ending_of(*output) : "";
  const auto is_its = [&](Format format) { return is_ending_of(ending, format); };
  if (ending.empty() || std::ranges::any_of(written, is_its)) return;
  std::string endings;
  for (const Format format : written) {
    const FormatInfo& info = info_of(format);
    endings +=
        (endings.empty() ? "" : ", or ") + listed(info.endings, "or") + " for " + std::string(info.title);
  }
  arguments.reject(option, "must end in " + endings + ", got " + in_quotes(*output));
}

Format format_of(Arguments& arguments, const std::optional<std::string>& output,
                 std::initializer_list<Format> offered) {
  const Format format = arguments.choice("--format", offered, *offered.begin());
  std::error_code none;
  if (!output || fs::is_directory(*output, none)) return format;
  const auto* const other =
      std::ranges::find_if(offered, [&](Format each) { return is_ending_of(ending_of(*output), each); });
  if (other == offered.end() || *other == format) {
    reject_other_endings(arguments, "--output", output, {format});
  } else {
    arguments.reject("--output", "ends as " + std::string(info_of(*other).title) + " does, which --format " +
                                     std::string(name_of(*other)) + " writes, got " + in_quotes(*output));
  }
  return format;
}

std::optional<std::string> output_of(Arguments& arguments, const std::string& option,
                                     std::initializer_list<Format> written,
                                     const std::vector<fs::path>& inputs) {
  auto output = arguments.file(option);
  arguments.reject_overwriting(option, output, inputs);
  reject_other_endings(arguments, option, output, written);
  return output;
}

void reject_same_output(Arguments& arguments, const std::string& option,
                        const std::optional<std::string>& file, const std::string& other_option,
                        const std::optional<std::string>& other) {
  const auto place = [](const std::string& name) { return fs::weakly_canonical(fs::absolute(name)); };
  if (file && other && place(*file) == place(*other))
    arguments.reject(option, "must be another file than " + other_option + ", got " + in_quotes(*file));
}

bool is_standard_output(const std::optional<std::string>& output) { return output == "-"; }

void prepare_output(const std::optional<std::string>& output) {
  if (!output || is_standard_output(output)) return;
  require_writable(*output);
  if_interrupted_say(left_as_it_was(*output));
}

void write_output(const std::optional<std::string>& output, std::string_view text) {
  if (output && !is_standard_output(output)) {
    write_file(*output, text);
  } else {
    write_standard_output(text);
  }
}

std::string aligned(const Rows& rows) {
  std::vector<std::size_t> widths(rows.front().size());
  for (const auto& row : rows)
    for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], width_of(row[i]));
  std::string text;
  for (const auto& row : rows) {
    for (std::size_t i = 0; i < row.size(); ++i) {
      text += row[i];
      if (i + 1 < row.size()) text.append(widths[i] - width_of(row[i]) + 2, ' ');
    }
    text += '\n';
  }
  return text;
}

std::string markdown_table(const Rows& rows) {
  std::string text;
  for (const auto& row : rows) {
    std::string line = "|", rule = "|";
    for (std::string cell : row) {
      for (std::size_t at = 0; (at = cell.find('|', at)) != std::string::npos; at += 2)
        cell.insert(at, 1, '\\');
      line += " " + cell + " |";
      rule += "---|";
    }
    text += line + '\n' + (text.empty() ? rule + '\n' : "");
  }
  return text;
}

double in_three_digits(double value) { return rounded_to(value, 3); }
std::string readable(double value) { return number_text(in_three_digits(value)); }

}  // namespace impact_damper::cli
