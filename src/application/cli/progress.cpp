#include "progress.hpp"

#include <unistd.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <cstring>
#include <deque>
#include <filesystem>
#include <iostream>
#include <system_error>

#include "drawing.hpp"
#include "impact_damper/io/file_output.hpp"

namespace impact_damper::cli {
namespace {

std::atomic<const char*> what_is_left = "impact-damper: interrupted: nothing is written\n";
static_assert(std::atomic<const char*>::is_always_lock_free);

// Calls only what a signal handler may. Ends with an exit code, as documented, rather than by the signal,
// which shells report with the same number.
extern "C" void end(int signal) {
  remove_unfinished_file();
  remove_drawing_board();
  const char* const text = what_is_left;
  if (::write(STDERR_FILENO, text, std::strlen(text)) < 0) {
    // Nobody reads stderr.
  }
  ::_exit(128 + signal);
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
  constexpr int first = 2, at_least_every = 10;  // seconds
  constexpr int minute = 60;                     // after n minutes at most a line in n seconds
  std::string reported;
  std::unique_lock lock(mutex_);
  for (int second = 1, last = 0; !changed_.wait_for(lock, 1s, [&] { return ended_; }); ++second) {
    const int silent = second - last;
    if (second < first || doing_.empty() || silent < second / minute) continue;
    if (doing_ == reported && silent < at_least_every) continue;
    std::cerr << command_ << ": " << doing_
              << (doing_ == reported ? ", " + std::to_string(second) + " s since the start" : "")
              << std::endl;
    reported = doing_;
    last = second;
  }
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
