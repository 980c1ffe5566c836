#include "progress.hpp"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstring>
#include <deque>
#include <filesystem>
#include <iostream>
#include <system_error>

#include "drawing.hpp"
#include "impact_damper/base/text.hpp"
#include "impact_damper/io/file_output.hpp"

namespace impact_damper::cli {
namespace {

std::atomic<const char*> what_is_left = "impact-damper: interrupted: nothing is written\n";
static_assert(std::atomic<const char*>::is_always_lock_free);
constexpr const char* erased_line = "\r\x1b[K";  // of a terminal, where progress is shown

// Calls only what a signal handler may. Ends with an exit code, as documented, rather than by the signal,
// which shells report with the same number.
extern "C" void end(int signal) {
  remove_unfinished_file();
  remove_drawing_board();
  for (const char* const text : {::isatty(STDERR_FILENO) == 1 ? erased_line : "", what_is_left.load()})
    if (::write(STDERR_FILENO, text, std::strlen(text)) < 0) break;  // nobody reads stderr
  ::_exit(128 + signal);
}

std::size_t columns_of_terminal() {
  constexpr unsigned short least = 20, otherwise = 80;
  winsize size{};
  const bool known = ::ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col >= least;
  return known ? size.ws_col : otherwise;
}

}  // namespace

ProgressOnStderr::ProgressOnStderr(std::string command) : command_(std::move(command)) {
  try {
    reporter_ = std::thread([this] { report(); });
  } catch (const std::system_error&) {
    // Without a thread the work continues without messages.
  }
}

ProgressOnStderr::~ProgressOnStderr() {
  {
    const std::lock_guard lock(mutex_);
    ended_ = true;
  }
  changed_.notify_all();
  if (reporter_.joinable()) reporter_.join();
}

void ProgressOnStderr::report() {
  using namespace std::chrono_literals;
  constexpr int at_least_every = 10;  // seconds
  constexpr int minute = 60;          // after n minutes at most a line in n seconds
  const bool is_terminal = ::isatty(STDERR_FILENO) == 1;
  const int first = is_terminal ? 2 : at_least_every;
  std::unique_lock lock(mutex_);
  bool has_line = false;
  for (int second = 1, last = 0; !changed_.wait_for(lock, 1s, [&] { return ended_; }); ++second) {
    const int silent = second - last;
    if (second < first || doing_.empty()) continue;
    if (!is_terminal && silent < std::max(at_least_every, second / minute)) continue;
    const std::string line = command_ + ": " + doing_;
    // A line of its own, or one that takes the place of the last; cut, because a terminal would wrap it.
    std::cerr << (is_terminal ? erased_line + cut(line, columns_of_terminal() - 4) : line + '\n')
              << std::flush;
    has_line = is_terminal;
    last = second;
  }
  if (has_line) std::cerr << erased_line << std::flush;
}

void end_cleanly() {
  struct sigaction action {};
  action.sa_handler = end;
  sigfillset(&action.sa_mask);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction before {};
    // They are ignored in a program that was started in the background or by nohup.
    if (::sigaction(signal, nullptr, &before) == 0 && before.sa_handler != SIG_IGN) {
      ::sigaction(signal, &action, nullptr);
    }
  }
  std::signal(SIGPIPE, SIG_DFL);
  std::signal(SIGXFSZ, SIG_IGN);
}

void if_interrupted_say(const std::string& text) {
  static std::deque<std::string> all;  // a signal handler may be reading the previous one
  what_is_left = all.emplace_back("impact-damper: interrupted: " + text + '\n').c_str();
}

std::string left_as_it_was(const std::string& file) {
  if (file == "-") return "nothing is written";
  std::error_code none;
  return file + (std::filesystem::exists(file, none) ? " is as it was" : " is not written");
}

}  // namespace impact_damper::cli
