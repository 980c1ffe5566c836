#include "drawing.hpp"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <string_view>

#include "files.hpp"
#include "impact_damper/io/file_output.hpp"
#include "impact_damper/io/json_reader.hpp"
#include "impact_damper/io/provenance.hpp"

extern char** environ;  // NOLINT(readability-redundant-declaration): POSIX has it declared by the user

namespace impact_damper::cli {
namespace {

namespace fs = std::filesystem;

// The data of remove_drawing_board(), in a form that a signal handler may read: paths, and the process that
// draws.
constexpr std::size_t most_files = 64, longest_path = 512;
std::array<std::array<char, longest_path>, most_files> left;  // files, then the folder
std::atomic<std::size_t> left_count{0};
std::atomic<pid_t> drawing_process{0};
static_assert(std::atomic<pid_t>::is_always_lock_free && std::atomic<std::size_t>::is_always_lock_free);

void note(const fs::path& path) {
  const std::size_t count = left_count;
  if (count == most_files || path.native().size() >= longest_path)
    throw IoError(path.string() + ": cannot be written: " + std::strerror(ENAMETOOLONG));
  std::memcpy(left[count].data(), path.c_str(), path.native().size() + 1);
  left_count = count + 1;
}

bool is_in_path(const std::string& program) {
  // Searches PATH as a shell does, without starting one, which may be missing as well.
  std::string_view path = "/usr/bin:/bin";
  for (char** each = environ; *each; ++each) {
    const std::string_view variable = *each;
    if (variable.starts_with("PATH=")) path = variable.substr(5);
  }
  while (true) {
    const std::size_t end = std::min(path.find(':'), path.size());
    const fs::path folder = end == 0 ? "." : fs::path(path.substr(0, end));
    if (::access((folder / program).c_str(), X_OK) == 0) return true;
    if (end == path.size()) return false;
    path.remove_prefix(end + 1);
  }
}

struct Ended {
  int code = 0;
  std::string complaint;  // what it wrote to its standard error, on one line
};

Ended run(std::vector<std::string> words) {
  std::array<int, 2> channel{};
  if (::pipe2(channel.data(), O_CLOEXEC) != 0) throw IoError("a pipe: " + std::string(std::strerror(errno)));
  std::vector<char*> arguments;
  arguments.reserve(words.size() + 1);
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  std::string svg_only = "SVG_ONLY=1";
  std::vector<char*> surroundings{svg_only.data()};
  for (char** each = environ; *each; ++each) surroundings.push_back(*each);
  surroundings.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  ::posix_spawn_file_actions_init(&actions);
  ::posix_spawn_file_actions_adddup2(&actions, channel[1], STDERR_FILENO);
  ::posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  pid_t process = 0;
  const int failed =
      ::posix_spawn(&process, arguments[0], &actions, nullptr, arguments.data(), surroundings.data());
  drawing_process = failed ? 0 : process;
  ::posix_spawn_file_actions_destroy(&actions);
  ::close(channel[1]);
  Ended ended;
  std::array<char, 4096> part{};
  while (!failed) {
    const ssize_t length = ::read(channel[0], part.data(), part.size());
    if (length < 0 && errno == EINTR) continue;
    if (length <= 0) break;
    ended.complaint.append(part.data(), static_cast<std::size_t>(length));
  }
  ::close(channel[0]);
  if (failed) throw IoError(words[0] + ": cannot be started: " + std::strerror(failed));
  int status = 0;
  while (::waitpid(process, &status, 0) < 0 && errno == EINTR) {
  }
  drawing_process = 0;
  ended.code = WIFEXITED(status) ? WEXITSTATUS(status) : 128;
  while (!ended.complaint.empty() && ended.complaint.back() == '\n') ended.complaint.pop_back();
  for (char& c : ended.complaint)
    if (c == '\n') c = ' ';
  return ended;
}

}  // namespace

void require_gnuplot(std::string_view otherwise) {
  if (!is_in_path("gnuplot"))
    throw IoError("gnuplot: cannot be found in PATH: it draws the figures, install it (Debian: gnuplot-nox)" +
                  std::string(otherwise));
}

DrawingBoard::DrawingBoard() {
  std::error_code error;
  const fs::path place = fs::temp_directory_path(error);
  if (error) throw IoError("the folder for temporary files: " + error.message());
  std::string name = (place / "impact-damper.XXXXXX").string();
  if (!::mkdtemp(name.data())) throw IoError(name + ": cannot be written: " + std::strerror(errno));
  folder_ = name;
  left_count = 0;
  try {
    for (const EmbeddedFile& file : embedded_files()) {
      note(folder_ / file.name);
      write_file(folder_ / file.name, file.text);
    }
  } catch (...) {
    remove_drawing_board();
    fs::remove_all(folder_, error);
    throw;
  }
}

DrawingBoard::~DrawingBoard() {
  std::error_code ignored;
  fs::remove_all(folder_, ignored);
  left_count = 0;
}

std::string DrawingBoard::draw(const Drawing& drawing) {
  const fs::path table = folder_ / (drawing.name + ".dat"), stem = folder_ / drawing.name;
  const fs::path svg = stem.string() + ".svg";
  note(table);
  note(svg);
  write_file(table, to_text(drawing.table));
  const Ended ended = run({"/bin/sh", folder_ / "draw", folder_ / drawing.script, table, drawing.title, stem,
                           std::string(provenance().version)});
  if (ended.code == 5) throw IoError(ended.complaint);
  if (ended.code != 0)
    throw NumericalError("figure " + drawing.name + " cannot be drawn: " + ended.complaint);
  return read_text(svg);
}

std::optional<std::string> figures_folder(Arguments& arguments) {
  auto folder = arguments.file("--figures");
  if (folder && !fs::is_directory(*folder))
    arguments.reject("--figures", "must be an existing folder, got " + in_quotes(*folder));
  return folder;
}

Svgs drawn(const std::vector<Drawing>& drawings, ProgressOnStderr& progress) {
  Svgs svgs;
  DrawingBoard board;
  for (const Drawing& drawing : drawings) {
    progress("drawing figure " + drawing.name);
    svgs[drawing.name] = board.draw(drawing);
  }
  return svgs;
}

void write_figures(const std::string& folder, const Svgs& svgs) {
  for (const auto& [name, svg] : svgs) write_file(fs::path(folder) / (name + ".svg"), svg);
}

void remove_drawing_board() noexcept {
  // figures/draw cleans up behind itself when it is asked to end.
  if (const pid_t process = drawing_process; process > 0) {
    ::kill(process, SIGTERM);
    ::waitpid(process, nullptr, 0);
  }
  const std::size_t count = left_count;
  for (std::size_t i = 0; i < count; ++i) ::unlink(left[i].data());
  if (count == 0) return;
  char* const end = std::strrchr(left[0].data(), '/');
  if (!end) return;
  *end = '\0';
  ::rmdir(left[0].data());
}

}  // namespace impact_damper::cli
