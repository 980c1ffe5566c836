#include "application/sweeps/share_file.hpp"

#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>

#include "application/sweeps/hdf5_table.hpp"
#include "application/sweeps/plan_file.hpp"
#include "impact_damper/base/errors.hpp"
#include "impact_damper/base/number_text.hpp"
#include "impact_damper/io/file_output.hpp"
#include "impact_damper/io/json_parts.hpp"
#include "impact_damper/io/json_reader.hpp"
#include "impact_damper/io/run_file.hpp"

namespace impact_damper {
namespace {

namespace fs = std::filesystem;
using Layout = JsonWriter::Layout;

constexpr std::int64_t rows_of_a_block = 64;  // between two digests

std::string head_line(const ShareHead& head) {
  JsonWriter out("share");
  out.open_object(Layout::one_line);
  out.fields("schema", share_schema, "program", head.program, "part", head.part, "parts", head.parts);
  out.open_object("plan", Layout::one_line);
  write_plan_fields(out, head.plan);
  out.close();
  out.close();
  return '#' + out.finish();
}

ShareHead parse_head(const std::string& file, const std::string& line) {
  if (!line.starts_with("#{")) throw InputError(file, {{"", "must be a part of a sweep"}});
  JsonDocument document = JsonDocument::parse(file, line.substr(1));
  ObjectReader object = document.root();
  ShareHead head;
  if (object.require("schema")) object.word("schema", {share_schema});
  object.required("program", head.program, some_text);
  object.required("parts", head.parts, within(1, double(most_parts)));
  object.required("part", head.part, within(1, double(most_parts)));
  ObjectReader plan = object.required_object("plan");
  head.plan = read_plan_object(plan);
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
    "made "
    "it makes it again";

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
  Whole whole;
  Sha256 hash;
  std::uint64_t bytes = 0;
  const auto pass = [&](const std::string& line) {
    hash.add(line);
    hash.add("\n");
    bytes += line.size() + 1;
  };
  pass(first);
  std::int64_t run = rows_of_part(head.plan, head.part, head.parts).begin;
  const std::int64_t begin = run;
  std::string block, line;
  bool has_header = false;
  while (std::getline(stream, line) && !stream.eof()) {  // a line without an end was cut
    ++whole.lines;
    if (line.starts_with('#')) {
      if (!has_header || line != digest_line(run - begin, hash)) return whole;
      pass(line);
      visit(block);
      block.clear();
      whole.rows = run - begin;
      whole.bytes = bytes;
      whole.hash = hash;
    } else if (!has_header) {
      if (line != header_of(head.plan)) return whole;
      has_header = true;
      pass(line);
    } else {
      if (!line.starts_with(std::to_string(run) + ',')) return whole;
      ++run;
      pass(line);
      block += line;
      block += '\n';
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
  errno = 0;
  OpenShare share{std::ifstream(file, std::ios::binary), {}, {}};
  if (!share.stream) throw IoError(file.string() + ": cannot be read: " + std::strerror(errno ? errno : EIO));
  std::getline(share.stream, share.first);
  share.head = parse_head(file.string(), share.first);
  return share;
}

[[noreturn]] void reject(const fs::path& file, const std::string& why) {
  throw InputError(file.string(), {{"", why}});
}

}  // namespace

fs::path share_file(const fs::path& table, std::int64_t part, std::int64_t parts) {
  fs::path file = table;
  file += ".part-" + std::to_string(part) + "-of-" + std::to_string(parts);
  return file;
}

ShareWriter::ShareWriter(const fs::path& file, const ShareHead& head) : file_(file) {
  require_writable(file);
  errno = 0;
  stream_.reset(std::fopen(file.c_str(), "ab"));
  if (!stream_) throw IoError(file.string() + ": cannot be written: " + std::strerror(errno));
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
      reject(file, "holds runs of another plan, part or program, with which these must not be mixed: " +
                       (is_of_it ? "the program is the same" : "this program is " + head.program) +
                       "; remove it, or choose another --output");
    }
    whole = scan(there, head, first, [](const std::string&) {});
  }
  if (::ftruncate(::fileno(stream_.get()), static_cast<off_t>(whole.bytes)) != 0)
    throw IoError(file.string() + ": cannot be written: " + std::strerror(errno));
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
  if (std::fwrite(text.data(), 1, text.size(), stream_.get()) != text.size())
    throw IoError(file_.string() + ": cannot be written: " + std::strerror(errno));
}

void ShareWriter::seal() {
  write(digest_line(rows_, hash_) + '\n');
  if (std::fflush(stream_.get()) != 0)
    throw IoError(file_.string() + ": cannot be written: " + std::strerror(errno));
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
  if (std::fclose(stream_.release()) != 0)
    throw IoError(file_.string() + ": cannot be written: " + std::strerror(errno));
}

std::string description_of_table(const ShareHead& head, std::uint64_t bytes, const std::string& digest) {
  JsonWriter out("sweep");
  out.open_object(Layout::lines);
  out.field("schema", "impact-damper/sweep/1");
  out.open_object("plan", Layout::one_line);
  write_plan_fields(out, head.plan);
  out.close();
  out.open_array("columns", Layout::lines);
  for (const PlanColumn& column : columns_of(head.plan)) {
    out.open_object(Layout::one_line);
    out.fields("name", column.name, "unit", column.unit, "meaning", column.meaning);
    out.close();
  }
  out.close();
  out.object("table", Layout::one_line, "rows", runs_of(head.plan), "bytes", std::int64_t(bytes), "sha256",
             digest);
  out.field("program", head.program);
  write_provenance(out);
  return sealed(out.finish());
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
      problems.push_back(file.string() + ": must be of the same plan and program, in as many parts, as " +
                         shares[0].first.string());
  }
  if (!problems.empty()) throw InputError(problems);
  for (std::size_t i = 1; i < shares.size(); ++i)
    if (shares[i].second.part == shares[i - 1].second.part)
      problems.push_back(shares[i].first.string() + ": is part " + std::to_string(shares[i].second.part) +
                         ", as " + shares[i - 1].first.string() + " is");
  std::int64_t next = 1;
  for (const auto& [file, head] : shares) {
    for (; next < head.part; ++next)
      problems.push_back(table.string() + ": part " + std::to_string(next) + " of " +
                         std::to_string(head.parts) + " is missing");
    next = head.part + 1;
  }
  for (; next <= expected.parts; ++next)
    problems.push_back(table.string() + ": part " + std::to_string(next) + " of " +
                       std::to_string(expected.parts) + " is missing");
  if (!problems.empty()) throw InputError(problems);

  const auto for_each_block = [&](const auto& pass) {
    for (const auto& [file, head] : shares) {
      OpenShare share = open(file);
      const Whole whole = scan(share.stream, head, share.first, pass);
      const std::int64_t needed = rows_of_part(head.plan, head.part, head.parts).size();
      if (!whole.complete && is_altered(file.string(), share.first)) reject(file, altered);
      if (!whole.complete)
        reject(
            file,
            "line " + std::to_string(whole.lines) +
                " is not what it was when it was written: a row is "
                "altered, missing or doubled, or the part is not finished; the command that made it goes on "
                "from there");
      if (whole.rows != needed)
        reject(file, "must hold " + std::to_string(needed) + " runs, got " + std::to_string(whole.rows) +
                         ": it is not finished; the command that made it goes on from there");
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
      Hdf5Table made(temporary, expected.plan);
      for_each_block([&](std::string_view rows) { made.add(rows); });
      made.finish();
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
  fs::path description = table;
  description += ".json";
  write_file(description, description_of_table(expected, bytes, hash.digest()));
}

}  // namespace impact_damper
