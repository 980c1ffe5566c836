#include "application/sweeps/sweep_table.hpp"

#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>

#include "impact_damper/base/errors.hpp"
#include "impact_damper/base/number_text.hpp"
#include "impact_damper/io/csv.hpp"
#include "impact_damper/io/file_output.hpp"
#include "impact_damper/io/json_parts.hpp"
#include "impact_damper/io/json_reader.hpp"
#include "impact_damper/io/run_file.hpp"

namespace impact_damper {
namespace {

namespace fs = std::filesystem;
using Layout = JsonWriter::Layout;

constexpr std::string_view share_schema = "impact-damper/share/1", table_schema = "impact-damper/sweep/1";
constexpr FileKind sweep_kind{"sweep", 1 << 24};
constexpr std::int64_t rows_of_a_block = 64;  // between two digests

[[noreturn]] void reject(const fs::path& file, const std::string& why) {
  throw InputError(file.string(), {{"", why}});
}
// Throws the IoError for what the last call of the C library reports.
[[noreturn]] void fail(const fs::path& file, const std::string& what) {
  throw IoError(file.string() + ": cannot be " + what + ": " + std::strerror(errno ? errno : EIO));
}

std::ifstream opened(const fs::path& file) {
  errno = 0;
  std::ifstream stream(file, std::ios::binary);
  if (!stream) fail(file, "read");
  return stream;
}

std::string head_line(const ShareHead& head) {
  JsonWriter out("share");
  out.open_object(Layout::one_line);
  out.fields("schema", share_schema, "program", head.program, "part", head.part, "parts", head.parts);
  write_plan(out, head.plan);
  out.close();
  return '#' + out.finish();
}

ShareHead parse_head(const std::string& file, const std::string& line) {
  if (!line.starts_with("#{")) reject(file, "must be a part of a sweep");
  JsonDocument document = JsonDocument::parse(file, line.substr(1));
  ObjectReader object = document.root();
  ShareHead head;
  if (object.require("schema")) object.word("schema", {share_schema});
  object.required("program", head.program, some_text);
  object.required("parts", head.parts, within(1, double(most_parts)));
  object.required("part", head.part, within(1, double(most_parts)));
  head.plan = read_plan_in(object);
  document.finish();
  if (head.part > head.parts) throw InputError(file, {{"/part", "must be <= parts"}});
  return head;
}

// Whether `line`, the first of a share, differs from what was written by ends of lines or other blanks, which
// a JSON reader ignores.
bool is_altered(const std::string& file, const std::string& line) {
  try {
    return head_line(parse_head(file, line)) != line;
  } catch (const InputError&) {
    return false;  // another file
  }
}
constexpr const char* altered =
    "is altered: its lines, or their ends, are not as they were written; remove it, and the command that "
    "made it makes it again";

std::string digest_line(std::int64_t rows, const Sha256& hash) {
  return "# " + std::to_string(rows) + ' ' + hash.digest();
}

// How much of a share is complete.
struct Whole {
  std::int64_t rows = -1;   // -1: not even its header
  std::uint64_t bytes = 0;  // up to the last correct digest
  Sha256 hash;              // of these
  std::int64_t lines = 1;   // that were read
  bool complete = false;    // nothing follows
};

// Reads a share after its head line `first` and returns how much is complete. visit(rows) is called with the
// rows of each complete block, with their ends of line.
template <class Visit>
Whole scan(std::istream& stream, const ShareHead& head, const std::string& first, Visit visit) {
  Whole whole, read;  // as far as it is certain, and as far as it was read
  const auto pass = [&](const std::string& line) {
    read.hash.add(line);
    read.hash.add("\n");
    read.bytes += line.size() + 1;
  };
  pass(first);
  const std::int64_t begin = rows_of_part(head.plan, head.part, head.parts).begin;
  std::string block, line;
  while (std::getline(stream, line) && !stream.eof()) {  // a line without an end was cut
    whole.lines = ++read.lines;
    const bool has_header = read.rows >= 0;
    if (line.starts_with('#')) {
      if (!has_header || line != digest_line(read.rows, read.hash)) return whole;
      pass(line);
      visit(block);
      block.clear();
      whole = read;
    } else if (!has_header) {
      if (line != header_of(head.plan)) return whole;
      read.rows = 0;
      pass(line);
    } else {
      if (!line.starts_with(std::to_string(begin + read.rows) + ',')) return whole;
      ++read.rows;
      pass(line);
      block += line + '\n';
    }
  }
  whole.complete = line.empty() && block.empty() && whole.rows >= 0;
  return whole;
}

struct OpenShare {
  std::ifstream stream;
  std::string first;
  ShareHead head;
};
OpenShare open(const fs::path& file) {
  OpenShare share{opened(file), {}, {}};
  std::getline(share.stream, share.first);
  share.head = parse_head(file.string(), share.first);
  return share;
}

// Returns the text of the description of a table.
std::string description_text(const ShareHead& head, std::uint64_t bytes, const std::string& digest) {
  JsonWriter out("sweep");
  out.open_object(Layout::lines);
  out.field("schema", table_schema);
  write_plan(out, head.plan);
  out.objects("columns", Layout::lines, columns_of(head.plan), [&](const PlanColumn& column) {
    out.fields("name", column.name, "unit", column.unit, "meaning", column.meaning);
  });
  out.object("table", Layout::one_line, "rows", runs_of(head.plan), "bytes", std::int64_t(bytes), "sha256",
             digest);
  out.field("program", head.program);
  write_provenance(out);
  return sealed(out.finish());
}
// Returns its place.
fs::path description_of(fs::path table) { return table += ".json"; }

// Rejects columns other than those of the plan, as they were written.
void check_columns(ObjectReader& root, const Plan& plan) {
  const std::vector<PlanColumn> expected = columns_of(plan);
  const std::vector<ObjectReader> columns = root.required_objects("columns", 10'000);
  if (!root.all_valid()) return;
  if (columns.size() != expected.size())
    root.reject("columns", filled("must be the {} of the plan, got {}", expected.size(), columns.size()));
  for (std::size_t i = 0; i < std::min(columns.size(), expected.size()); ++i) {
    ObjectReader column = columns[i];
    column.word("name", {expected[i].name});
    column.word("unit", {expected[i].unit});
    column.word("meaning", {expected[i].meaning});
  }
}

}  // namespace

fs::path share_file(const fs::path& table, std::int64_t part, std::int64_t parts) {
  return filled("{}.part-{}-of-{}", table, part, parts);
}

ShareWriter::ShareWriter(const fs::path& file, const ShareHead& head) : file_(file) {
  require_writable(file);
  errno = 0;
  stream_.reset(std::fopen(file.c_str(), "ab"));
  if (!stream_) fail(file, "written");
  // Not every file system has locks. Without them the digests reveal what two processes have written at once.
  if (::flock(::fileno(stream_.get()), LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK)
    throw IoError(file.string() + ": cannot be written: another sweep is writing it");
  const std::string first = head_line(head);
  std::ifstream there(file, std::ios::binary);
  std::string line;
  std::getline(there, line);
  const bool is_cut = there.eof();  // within its first line, or before it
  if (is_cut && !first.starts_with(line))
    reject(file, "must be a part of this sweep, got another file; remove it, or choose another --output");
  Whole whole;
  if (!is_cut) {
    if (line != first) {
      const bool is_of_it = line.find(in_quotes(head.program)) != std::string::npos;
      if (is_of_it && is_altered(file.string(), line)) reject(file, altered);
      reject(file, filled("holds runs of another plan, part or program, with which these must not be mixed: "
                          "{}; remove it, or choose another --output",
                          is_of_it ? "the program is the same" : "this program is " + head.program));
    }
    whole = scan(there, head, first, [](const std::string&) {});
  }
  if (::ftruncate(::fileno(stream_.get()), static_cast<off_t>(whole.bytes)) != 0) fail(file, "written");
  hash_ = whole.hash;
  if (whole.rows >= 0) {
    rows_ = kept_ = whole.rows;
    return;
  }
  write(first + '\n' + header_of(head.plan) + '\n');
  seal();
}

void ShareWriter::write(std::string_view text) {
  hash_.add(text);
  if (std::fwrite(text.data(), 1, text.size(), stream_.get()) != text.size()) fail(file_, "written");
}

void ShareWriter::seal() {
  write(digest_line(rows_, hash_) + '\n');
  if (std::fflush(stream_.get()) != 0) fail(file_, "written");
  kept_ = rows_;
}

void ShareWriter::append(std::string_view row) {
  write(row);
  write("\n");
  ++rows_;
  if (rows_ - kept_ == rows_of_a_block) seal();
}

void ShareWriter::finish() {
  if (kept_ < rows_) seal();
  if (std::fclose(stream_.release()) != 0) fail(file_, "written");
}

void join_shares(const std::vector<fs::path>& files, const fs::path& table) {
  if (files.empty()) throw InvalidArguments(std::vector<Problem>{{"files", "at least one must be given"}});
  // Sorted by part. Problems of the whole set are reported before any share is read to its end.
  std::vector<std::pair<fs::path, ShareHead>> shares;
  shares.reserve(files.size());
  for (const fs::path& file : files) shares.emplace_back(file, open(file).head);
  std::ranges::stable_sort(shares, {}, [](const auto& share) { return share.second.part; });
  ShareHead expected = shares[0].second;
  std::vector<std::string> problems;
  for (const auto& [file, head] : shares) {
    expected.part = head.part;
    if (head_line(head) != head_line(expected))
      problems.push_back(
          filled("{}: must be of the same plan and program, in as many parts, as {}", file, shares[0].first));
  }
  if (!problems.empty()) throw InputError(problems);
  for (std::size_t i = 1; i < shares.size(); ++i)
    if (shares[i].second.part == shares[i - 1].second.part)
      problems.push_back(
          filled("{}: is part {}, as {} is", shares[i].first, shares[i].second.part, shares[i - 1].first));
  std::int64_t next = 1;
  const auto demand_parts_before = [&](std::int64_t part) {
    for (; next < part; ++next)
      problems.push_back(filled("{}: part {} of {} is missing", table, next, expected.parts));
    next = part + 1;
  };
  for (const auto& share : shares) demand_parts_before(share.second.part);
  demand_parts_before(expected.parts + 1);
  if (!problems.empty()) throw InputError(problems);

  const auto for_each_block = [&](const AddRows& pass) {
    for (const auto& [file, head] : shares) {
      OpenShare share = open(file);
      const Whole whole = scan(share.stream, head, share.first, pass);
      const std::int64_t needed = rows_of_part(head.plan, head.part, head.parts).size();
      if (!whole.complete && is_altered(file.string(), share.first)) reject(file, altered);
      if (!whole.complete)
        reject(file,
               filled("line {} is not what it was when it was written: a row is altered, missing or "
                      "doubled, or the part is not finished; the command that made it goes on from there",
                      whole.lines));
      if (whole.rows != needed)
        reject(file, filled("must hold {} runs, got {}: it is not finished; the command that made it goes on "
                            "from there",
                            needed, whole.rows));
    }
  };
  Sha256 hash;
  std::uint64_t bytes = 0;
  const auto count = [&](std::string_view text) {
    hash.add(text);
    bytes += text.size();
  };
  if (is_hdf5(table)) {
    write_file_by(table, [&](const fs::path& temporary) {
      write_hdf5_table(temporary, expected.plan, for_each_block);
      std::ifstream written(temporary, std::ios::binary);
      std::string piece(1 << 20, '\0');
      while (written.read(piece.data(), std::streamsize(piece.size())), written.gcount() > 0)
        count(std::string_view(piece).substr(0, std::size_t(written.gcount())));
    });
  } else {
    write_file_in_pieces(table, [&](const AddText& add) {
      const auto pass = [&](std::string_view text) {
        add(text);
        count(text);
      };
      pass(header_of(expected.plan) + '\n');
      for_each_block(pass);
    });
  }
  expected.part = 1;
  write_file(description_of(table), description_text(expected, bytes, hash.digest()));
}

SweepDescription read_sweep_description(const fs::path& table) {
  if (is_hdf5(table))
    reject(table, "must be a table as CSV: make it again, or merge its parts, with -o " +
                      fs::path(table).replace_extension(".csv").string());
  SealedDocument document = SealedDocument::read(description_of(table), sweep_kind);
  ObjectReader root = document.root();
  if (root.require("schema")) root.word("schema", {table_schema});
  SweepDescription description;
  description.plan = read_plan_in(root);
  check_columns(root, description.plan);
  ObjectReader holds = root.required_object("table");
  holds.required("rows", description.rows, within(0, double(most_runs)));
  holds.required("bytes", description.bytes, within(0, 9e15));
  holds.required("sha256", description.digest, TextRule{64, 64});
  std::string program;
  root.required("program", program);
  if (root.all_valid() && description.rows != runs_of(description.plan))
    holds.reject("rows",
                 filled("must be the {} of the plan, got {}", runs_of(description.plan), description.rows));
  document.finish(root);
  return description;
}

void read_sweep_rows(const fs::path& table, const SweepDescription& description,
                     const std::function<void(std::span<const std::string> cells)>& visit) {
  std::ifstream stream = opened(table);
  Sha256 hash;
  std::string line;
  std::int64_t lines = 0, bytes = 0;
  for (; bytes <= description.bytes && std::getline(stream, line); ++lines) {
    if (!stream.eof()) line += '\n';
    hash.add(line);
    bytes += std::int64_t(line.size());
  }
  if (bytes != description.bytes || lines != description.rows + 1 || hash.digest() != description.digest)
    reject(table, filled("is not the table that {} describes: its length or SHA-256 is another",
                         description_of(table)));
  stream.clear();
  stream.seekg(0);
  std::getline(stream, line);
  std::vector<std::string> cells;
  while (std::getline(stream, line)) {
    CsvRows(line).next(cells);
    visit(cells);
  }
}

SweepTable read_sweep_table(const fs::path& table, const Plan& plan) {
  const SweepDescription description = read_sweep_description(table);
  if (plan_text(description.plan) != plan_text(plan))
    reject(table, "must be of the plan that is asked for, is of another");
  SweepTable found{table, description.plan, {}};
  read_sweep_rows(table, description, [&](std::span<const std::string> cells) {
    found.rows.emplace_back(cells.begin(), cells.end());
  });
  return found;
}

}  // namespace impact_damper
