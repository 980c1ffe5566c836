// Ended from outside: Ctrl-C, a closed terminal, a reader that has seen enough.
#pragma once

#include <string>

namespace impact_damper::cli {

// From now on SIGINT, SIGTERM and SIGHUP, unless they are ignored already, end the program at once: one line
// on stderr says what is left, the file being written goes away, and the exit code is 128 plus the signal's
// number, 130 for SIGINT. A pipe that nobody reads any more ends it quietly, and a file that outgrows the
// limit on its size is an error of writing it, not an end.
void end_cleanly();

// What that line says after "interrupted: ". Commands renew it as they go on.
void if_interrupted_say(const std::string& text);

// The same for what a file's writing leaves: it is kept as it was, or not there. Of "-": nothing is written.
std::string left_as_it_was(const std::string& file);

}  // namespace impact_damper::cli
