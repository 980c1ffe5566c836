// Handling of an end from outside: Ctrl-C, a closed terminal, a pipe whose reader has ended.
#pragma once

#include <string>

namespace impact_damper::cli {

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
