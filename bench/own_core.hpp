// Whether the core is one's own for the moment.
//
// A processor may be half a core, whose other half is another guest's. The two share caches, the decoder and
// the memory of branches: long code that branches much takes a fifth to a third longer beside a busy
// neighbour, and a chain of operations that wait for each other, as the reference operation is, hardly
// notices. What does notice is a short sort: the third time over, a core of one's own knows each of its
// branches.
#pragma once

#include <vector>

namespace impact_damper::bench {

class OwnCore {
 public:
  OwnCore();
  // Asks once more. Beside a neighbour a sort takes twice as long at least: 1.75 times the fastest is the
  // limit.
  bool now();

 private:
  double sorting() const;  // CPU seconds

  std::vector<unsigned> numbers_;
  double least_;
};

}  // namespace impact_damper::bench
