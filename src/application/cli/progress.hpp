// What a command that takes long reports: how far it is, and what is left when it is ended from outside, by
// Ctrl-C, a closed terminal, or a pipe whose reader has ended.
#pragma once

#include <condition_variable>
#include <mutex>
#include <string>
#include <thread>
#include <utility>

namespace impact_damper::cli {

// Reports on stderr what is being done: on a terminal after two seconds, in one line that each second
// rewrites and the end removes; elsewhere a line in ten seconds, after minutes less often, so that the log of
// a day has 500 lines, and none of what ends sooner. A thread of its own reports it, also during a long
// simulation.
class ProgressOnStderr {
 public:
  explicit ProgressOnStderr(std::string command);
  ProgressOnStderr(const ProgressOnStderr&) = delete;
  ProgressOnStderr& operator=(const ProgressOnStderr&) = delete;
  ~ProgressOnStderr();
  // May be called from several threads.
  void operator()(const std::string& doing) {
    const std::lock_guard lock(mutex_);
    doing_ = doing;
  }

 private:
  void report();

  std::string command_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::string doing_;
  bool ended_ = false;
  std::thread reporter_;
};

// After this call SIGINT, SIGTERM and SIGHUP, unless they are ignored already, end the program at once: one
// line on stderr reports what is left, the file being written is removed, and the exit code is 128 plus the
// signal's number, 130 for SIGINT. A pipe without a reader ends the program without a message, and a file
// that outgrows the limit on its size is an error of writing it, not an end.
void end_cleanly();

// Sets the text of that line after "interrupted: ". Commands update it as they proceed.
void if_interrupted_say(const std::string& text);

// Returns that text for a file that is written: it is kept as it was, or does not exist. For "-": nothing is
// written.
std::string left_as_it_was(const std::string& file);

}  // namespace impact_damper::cli
