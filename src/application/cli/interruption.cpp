#include "interruption.hpp"

#include <unistd.h>

#include <atomic>
#include <csignal>
#include <cstring>
#include <deque>
#include <filesystem>

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
