#include "impact_damper/io/file_output.hpp"

#include <doctest/doctest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <string>
#include <utility>
#include <vector>

#include "application/reproduction/manifest.hpp"
#include "impact_damper/base/errors.hpp"
#include "impact_damper/io/json_reader.hpp"

using namespace impact_damper;
namespace fs = std::filesystem;

namespace {

// An empty folder that goes away with the test.
struct Folder {
  fs::path path = fs::temp_directory_path() / ("impact-damper-" + std::to_string(::getpid()));
  Folder() { fs::create_directory(path); }
  ~Folder() { fs::remove_all(path); }
  auto files() const { return std::distance(fs::directory_iterator(path), fs::directory_iterator()); }
};

}  // namespace

TEST_CASE("a file is written whole, and nothing else is left in its folder") {
  const Folder folder;
  const fs::path file = folder.path / "a.txt";
  CHECK(write_file(file, "one"));
  CHECK(read_text(file) == "one");
  CHECK(write_file(file, "two"));
  CHECK(read_text(file) == "two");
  CHECK(folder.files() == 1);
}

TEST_CASE("a file that already has the bytes keeps its time stamp") {
  const Folder folder;
  const fs::path file = folder.path / "a.txt";
  write_file(file, "same");
  const auto long_ago = fs::last_write_time(file) - std::chrono::hours(1);
  fs::last_write_time(file, long_ago);
  CHECK(!write_file(file, "same"));
  CHECK(fs::last_write_time(file) == long_ago);
  CHECK(write_file(file, "diff"));
  CHECK(fs::last_write_time(file) != long_ago);
}

TEST_CASE("permissions stay, and a link stays a link") {
  const Folder folder;
  const fs::path file = folder.path / "a.txt", link = folder.path / "link.txt";
  write_file(file, "one");
  fs::permissions(file, fs::perms::owner_read | fs::perms::owner_write);
  fs::create_symlink("a.txt", link);
  CHECK(write_file(link, "two"));
  CHECK(fs::is_symlink(link));
  CHECK(read_text(file) == "two");
  CHECK(fs::status(file).permissions() == (fs::perms::owner_read | fs::perms::owner_write));
}

TEST_CASE("what cannot be written is rejected and leaves nothing behind") {
  const Folder folder;
  CHECK_THROWS_WITH_AS(write_file(folder.path, "x"), doctest::Contains("is a directory"), IoError);
  CHECK_THROWS_WITH_AS(write_file(folder.path / "no" / "a.txt", "x"), doctest::Contains("No such file"),
                       IoError);
  CHECK_THROWS_AS(write_file("", "x"), IoError);
  CHECK_THROWS_WITH_AS(write_file("/dev/full", "x"), doctest::Contains("No space left"), IoError);
  CHECK_THROWS_AS(write_file(folder.path / std::string(255, 'a'), "x"), IoError);
  CHECK(fs::is_character_file("/dev/full"));
  CHECK(folder.files() == 0);
}

TEST_CASE("a disk that fills up while writing leaves the old file and no temporary one") {
  const Folder folder;
  const fs::path file = folder.path / "a.txt";
  write_file(file, "old");
  // A limit on the size of files stands in for the full disk.
  std::signal(SIGXFSZ, SIG_IGN);
  rlimit limit{};
  getrlimit(RLIMIT_FSIZE, &limit);
  const rlimit tight{1000, limit.rlim_max};
  setrlimit(RLIMIT_FSIZE, &tight);
  CHECK_THROWS_WITH_AS(write_file(file, std::string(100'000, 'x')), doctest::Contains("too large"), IoError);
  setrlimit(RLIMIT_FSIZE, &limit);
  CHECK(read_text(file) == "old");
  CHECK(folder.files() == 1);
}

TEST_CASE(
    "what killed processes left of a file goes when it is written again, what others are writing stays") {
  const Folder folder;
  const fs::path file = folder.path / "a.txt";
  // Process numbers end well below this one.
  const fs::path abandoned = folder.path / ".a.txt.2000000000.tmp";
  const fs::path alive = folder.path / (".a.txt." + std::to_string(::getppid()) + ".tmp");
  const fs::path anothers = folder.path / ".b.txt.2000000000.tmp", unlike = folder.path / ".a.txt.mine.tmp";
  const std::vector<fs::path> all{abandoned, alive, anothers, unlike};
  for (const bool anew : {true, false}) {
    for (const fs::path& each : all) write_file(each, "half");
    CHECK(write_file(file, "whole") == anew);
    CHECK(!fs::exists(abandoned));
    CHECK(fs::exists(alive));
    CHECK(fs::exists(anothers));
    CHECK(fs::exists(unlike));
  }
}

TEST_CASE("a temporary file that a process of the same number left is no obstacle, nor where it leads") {
  const Folder folder;
  const fs::path file = folder.path / "a.txt", elsewhere = folder.path / "elsewhere.txt";
  write_file(elsewhere, "kept");
  fs::create_symlink(elsewhere, folder.path / (".a.txt." + std::to_string(::getpid()) + ".tmp"));
  CHECK(write_file(file, "whole"));
  CHECK(read_text(file) == "whole");
  CHECK(!fs::is_symlink(file));
  CHECK(read_text(elsewhere) == "kept");
  CHECK(folder.files() == 2);
}

TEST_CASE("files are compared to their last byte, however long") {
  const Folder folder;
  const fs::path file = folder.path / "a.txt";
  std::string text(200'000, 'x');
  write_file(file, text);
  CHECK(!write_file(file, text));
  text.back() = 'y';
  CHECK(write_file(file, text));
  CHECK(read_text(file) == text);
}

// --- Stamps of figures -------------------------------------------------------------------------------------

namespace {

// "1a2b3c4d" and then the digit `last` up to the end.
std::string sum(char last) { return "1a2b3c4d" + std::string(56, last); }

CitedFigure figure_of(std::string number, char exact, char cem) {
  CitedFigure figure;
  figure.number = std::move(number);
  figure.tables = {{"exact", {"a.dat", sum(exact)}}, {"cem", {"b.dat", sum(cem)}}};
  figure.script = {"a.gp", std::string(64, 'f')};
  return figure;
}

}  // namespace

TEST_CASE("a stamp is read as it stands on a picture, or as somebody types it") {
  for (const std::string text :
       {"1a2b3c4d · 0.1.0", "1A2B3C4D · 0.1.0", "  1a2b3c4d  0.1.0 ", "1a2b3c4d·0.1.0", "1a2B3c4D ·0.1.0"}) {
    CAPTURE(text);
    const auto stamp = parse_stamp(text);
    REQUIRE(stamp);
    CHECK(stamp->digits == "1a2b3c4d");
    CHECK(stamp->version == "0.1.0");
  }
  for (const std::string text : {"1a2b3c4d", " 1A2B3C4D ", "1a2b3c4d ·", "1a2b3c4d · "}) {
    CAPTURE(text);
    const auto stamp = parse_stamp(text);
    REQUIRE(stamp);
    CHECK(stamp->digits == "1a2b3c4d");
    CHECK_FALSE(stamp->version);
  }
  CHECK(parse_stamp(sum('0'))->digits == sum('0'));
}

TEST_CASE("what is no stamp is none") {
  for (const std::string& text : {std::string(), std::string("figure 8"), std::string("1a2b3c4"),
                                  std::string("1a2b3c4g"), std::string("1a2b3c4d-0.1.0"),
                                  std::string("1a2b3c4d · · 0.1.0"), std::string("1a2b3c4d · 0.1.0 beta"),
                                  std::string("1a2b3c4d \xc2"), std::string("1a2b3c4d\n"), sum('0') + '0'}) {
    CAPTURE(text);
    CHECK_FALSE(parse_stamp(text));
  }
}

TEST_CASE("a stamp finds every table that begins with it, and the script of a drawing only") {
  Manifest manifest;
  manifest.figures = {figure_of("1", '0', '1'), figure_of("2", '2', '3'), figure_of("A", '4', '5')};
  manifest.figures[2].tables.clear();
  const auto all = find_stamped(manifest, "1a2b3c4d");
  REQUIRE(all.size() == 4);
  CHECK(all[0].figure == &manifest.figures[0]);
  CHECK(all[0].table == &manifest.figures[0].tables[0]);
  CHECK(all[3].table == &manifest.figures[1].tables[1]);

  const auto one = find_stamped(manifest, "1a2b3c4d3");
  REQUIRE(one.size() == 1);
  CHECK(one[0].table->engine == "cem");

  const auto drawing = find_stamped(manifest, "ffffffff");
  REQUIRE(drawing.size() == 1);
  CHECK(drawing[0].figure == &manifest.figures[2]);
  CHECK_FALSE(drawing[0].table);

  CHECK(find_stamped(manifest, "00000000").empty());
}
