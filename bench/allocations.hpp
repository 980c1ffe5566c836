// How often a decay asks for memory. Linked into the bench program only: it replaces global operator new.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace impact_damper::bench {

struct Allocations {
  std::string engine;
  std::int64_t impacts = 0;
  std::int64_t quiet = 0;     // calls of operator new in a whole decay, nothing kept: what is not for columns
  std::int64_t recorded = 0;  // the same with all half cycles recorded
};
// The decay from 6 to 0.03. Throws std::logic_error if an allocation of the recorder's is not counted: the
// replacement would not be in force.
std::vector<Allocations> count_allocations();

}  // namespace impact_damper::bench
