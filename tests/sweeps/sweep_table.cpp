#include "application/sweeps/sweep_table.hpp"

#include <doctest/doctest.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <fstream>
#include <sstream>

#include "impact_damper/base/errors.hpp"
#include "impact_damper/io/json_reader.hpp"

using namespace impact_damper;
namespace fs = std::filesystem;

// Instead of the C library's: also for a file system without locks.
namespace {
bool has_locks = true;
}
extern "C" int flock(int file, int operation) noexcept {
  if (has_locks) return static_cast<int>(::syscall(SYS_flock, file, operation));
  errno = ENOLCK;
  return -1;
}

namespace {

struct Folder {
  fs::path path = fs::temp_directory_path() / ("impact-damper-shares-" + std::to_string(::getpid()));
  Folder() { fs::create_directory(path); }
  ~Folder() { fs::remove_all(path); }
};

// 150 runs: more than two digests' worth.
ShareHead head_of(std::int64_t part = 1, std::int64_t parts = 1) {
  return {.plan = parse_plan("plan.json", R"({"schema": "impact-damper/plan/1", "quantities": ["impacts"],
      "scene": {"until_time": 1}, "grid": [{"number": "x0", "from": 1, "to": 2, "count": 150}]})"),
          .part = part,
          .parts = parts,
          .program = "0.1.0 abc"};
}

// Rows as a sweep would have them, but for their numbers.
void fill(ShareWriter& share, const ShareHead& head) {
  const RowRange range = rows_of_part(head.plan, head.part, head.parts);
  for (std::int64_t run = range.begin + share.rows(); run < range.end; ++run)
    share.append(std::to_string(run) + ",1.5,3,done,");
  share.finish();
}
fs::path made(const fs::path& table, std::int64_t part, std::int64_t parts) {
  const ShareHead head = head_of(part, parts);
  const fs::path file = share_file(table, part, parts);
  ShareWriter share(file, head);
  fill(share, head);
  return file;
}
void put(const fs::path& file, const std::string& text) { std::ofstream(file, std::ios::binary) << text; }

// A share whose digests are right, whatever its rows are.
std::string with_digests(const std::string& text) {
  std::istringstream lines(text);
  std::string all;
  for (std::string line; std::getline(lines, line);)
    all += (line.starts_with("# ") ? line.substr(0, line.rfind(' ') + 1) + sha256(all) : line) + '\n';
  return all;
}

std::string problem_of_join(const std::vector<fs::path>& files, const fs::path& table) {
  try {
    join_shares(files, table);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

}  // namespace

TEST_CASE("wherever a share is cut off, it goes on to the same bytes") {
  const Folder folder;
  const fs::path file = made(folder.path / "t.csv", 1, 1);
  const std::string whole = read_text(file);
  for (std::size_t length = 0; length <= whole.size(); length += length < 2000 ? 17 : 97) {
    put(file, whole.substr(0, length));
    const ShareHead head = head_of();
    ShareWriter share(file, head);
    CHECK(share.rows() <= 150);
    CHECK(share.rows() % 64 * (share.rows() - 150) == 0);
    fill(share, head);
    REQUIRE(read_text(file) == whole);
  }
}

TEST_CASE("what follows an altered byte is made anew") {
  const Folder folder;
  const fs::path file = made(folder.path / "t.csv", 1, 1);
  const std::string whole = read_text(file);
  for (std::size_t at = whole.find('\n') + 1; at < whole.size(); at += 41) {
    std::string altered = whole;
    altered[at] = altered[at] == 'x' ? 'y' : 'x';
    put(file, altered);
    const ShareHead head = head_of();
    ShareWriter share(file, head);
    fill(share, head);
    REQUIRE(read_text(file) == whole);
  }
}

TEST_CASE(
    "a share whose lines have got other ends, or its head other blanks, is altered, not of another plan") {
  const Folder folder;
  const fs::path table = folder.path / "t.csv", file = made(table, 1, 1);
  const std::string whole = read_text(file);
  std::string other_ends, other_blanks = whole;
  for (const char c : whole) other_ends += c == '\n' ? std::string("\r\n") : std::string(1, c);
  other_blanks.insert(2, " ");
  for (const std::string& text : {other_ends, other_blanks}) {
    put(file, text);
    CHECK_THROWS_WITH_AS(ShareWriter(file, head_of()), doctest::Contains("is altered"), InputError);
    CHECK_THROWS_WITH_AS(join_shares({file}, table), doctest::Contains("is altered"), InputError);
    CHECK(read_text(file) == text);
  }
}

TEST_CASE("a share of another plan, part or program is not gone on with") {
  const Folder folder;
  const fs::path file = made(folder.path / "t.csv", 1, 1);
  const std::string whole = read_text(file);
  std::vector<ShareHead> others{head_of(), head_of(1, 2), head_of(), head_of()};
  others[0].program = "0.1.0 abd";
  others[2].plan.grid[0].to = 2.5;
  others[3].plan.forced.steady.tolerance = 1e-9;
  for (const ShareHead& other : others) CHECK_THROWS_AS(ShareWriter(file, other), InputError);
  CHECK(read_text(file) == whole);
}

TEST_CASE("a file that is no share is left as it was, also without an end of line") {
  const Folder folder;
  const fs::path file = folder.path / "t";
  for (const std::string text : {"my notes", "my notes\n", "#", "{}"}) {
    put(file, text);
    if (text == "#") {  // as far as it goes, the head of a share
      CHECK_NOTHROW(ShareWriter(file, head_of()));
      continue;
    }
    CHECK_THROWS_AS(ShareWriter(file, head_of()), InputError);
    CHECK(read_text(file) == text);
  }
}

TEST_CASE("two cannot write one share at a time") {
  const Folder folder;
  const ShareHead head = head_of();
  ShareWriter first(folder.path / "t", head);
  CHECK_THROWS_AS(ShareWriter(folder.path / "t", head), IoError);
}

TEST_CASE("where there are no locks, what two have written at once is not joined, and is gone on with") {
  const Folder folder;
  const fs::path table = folder.path / "t.csv", file = share_file(table, 1, 1);
  const ShareHead head = head_of();
  const std::string whole = read_text(made(table, 1, 1));
  has_locks = false;
  int spoilt = 0;
  for (int before = 0; before <= 150; before += 10) {
    fs::remove(file);
    ShareWriter first(file, head);
    const auto append = [](ShareWriter& share) {
      share.append(std::to_string(share.rows()) + ",1.5,3,done,");
    };
    while (first.rows() < before) append(first);
    ShareWriter second(file, head);
    while (second.rows() < 150) {
      if (first.rows() < 150) append(first);
      append(second);
    }
    fill(first, head);
    second.finish();
    if (problem_of_join({file}, table).empty()) {
      CHECK(read_text(file) == whole);
    } else {
      ++spoilt;
    }
    ShareWriter third(file, head);
    fill(third, head);
    CHECK(read_text(file) == whole);
  }
  has_locks = true;
  CHECK(spoilt > 0);
}

TEST_CASE("parts join to the bytes of one, in any order and any number") {
  const Folder folder;
  const fs::path one = folder.path / "one.csv", several = folder.path / "several.csv";
  join_shares({made(one, 1, 1)}, one);
  const std::string table = read_text(one), description = read_text(fs::path(one) += ".json");
  CHECK(table.starts_with("run,x0,impacts,end,problem\n0,1.5,3,done,\n1,1.5,3,done,\n"));
  CHECK(table.find('#') == std::string::npos);
  CHECK(description.find(sha256(table)) != std::string::npos);
  for (const std::int64_t parts : {2, 3, 200}) {
    std::vector<fs::path> files;
    for (std::int64_t part = parts; part >= 1; --part) files.push_back(made(several, part, parts));
    join_shares(files, several);
    CHECK(read_text(several) == table);
    CHECK(read_text(fs::path(several) += ".json") == description);
  }
}

TEST_CASE("parts that are missing, doubled, unfinished or of something else are not joined") {
  const Folder folder;
  const fs::path table = folder.path / "t.csv";
  const fs::path a = made(table, 1, 3), b = made(table, 2, 3), c = made(table, 3, 3);
  CHECK(problem_of_join({a, c}, table) == table.string() + ": part 2 of 3 is missing");
  CHECK_THROWS_AS(join_shares({}, table), InvalidArguments);
  CHECK(problem_of_join({b}, table) ==
        table.string() + ": part 1 of 3 is missing\n" + table.string() + ": part 3 of 3 is missing");
  const fs::path copy = folder.path / "copy";
  fs::copy(b, copy);
  CHECK(problem_of_join({a, b, c, copy}, table) == copy.string() + ": is part 2, as " + b.string() + " is");

  const std::string whole = read_text(b);
  const auto with_b = [&](const std::string& text) {
    put(b, text);
    return problem_of_join({a, b, c}, table);
  };
  const auto replaced = [&](const std::string& from, const std::string& to) {
    std::string other = whole;
    return other.replace(other.find(from), from.size(), to);
  };
  for (const std::string& other : {replaced("0.1.0 abc", "0.1.1 abc"), replaced("\"to\": 2", "\"to\": 3")})
    CHECK(with_b(with_digests(other)).starts_with(b.string() + ": must be of the same plan and program"));
  // A row that is doubled, missing or altered, by an accident that does not know of digests, and by one that
  // does.
  const std::size_t row = whole.find("\n57,") + 1, end = whole.find('\n', row) + 1;
  const std::string doubled = whole.substr(0, end) + whole.substr(row),
                    missing = whole.substr(0, row) + whole.substr(end);
  std::string altered = whole;
  altered[end - 3] = 'x';
  for (const std::string& text :
       {doubled, missing, with_digests(doubled), with_digests(missing),
        with_digests(replaced("\n57,", "\n56,")),  // one doubled for one that is missing
        altered, whole.substr(0, whole.size() - 1), whole + "107,1,2,done,\n",
        whole.substr(0, whole.rfind("\n# ") + 1)})
    CHECK(with_b(text).starts_with(b.string() + ": line "));
  put(b, whole.substr(0, whole.find("\n50,") + 1));
  CHECK(problem_of_join({a, b, c}, table)
            .starts_with(b.string() + ": must hold 50 runs, got 0: it is not finished"));
  CHECK_FALSE(fs::exists(table));
  put(b, whole);
  join_shares({c, a, b}, table);
  CHECK(fs::exists(table));
}
