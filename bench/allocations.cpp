#include <cstdlib>
#include <new>
#include <stdexcept>

#include "impact_damper/engines/exact.hpp"
#include "impact_damper/engines/recorder.hpp"
#include "impact_damper/engines/restitution.hpp"
#include "measurements.hpp"
#include "quiet_observer.hpp"

namespace {

thread_local std::int64_t calls = 0;

}  // namespace

void* operator new(std::size_t size) {
  ++calls;
  if (void* memory = std::malloc(size ? size : 1)) return memory;
  throw std::bad_alloc();
}
void* operator new(std::size_t size, std::align_val_t alignment) {
  ++calls;
  const std::size_t unit = std::size_t(alignment);
  if (void* memory = std::aligned_alloc(unit, (size + unit - 1) / unit * unit)) return memory;
  throw std::bad_alloc();
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { std::free(memory); }

namespace impact_damper::bench {
namespace {

template <class Engine>
Allocations count_with(const std::string& name, const Checked& decay, Engine&& engine) {
  Allocations counted{.engine = name};
  QuietObserver quiet;
  const std::int64_t begin = calls;
  engine(decay, quiet);
  counted.quiet = calls - begin;
  counted.impacts = quiet.impacts;

  Recorder recorder({.half_cycles = true});
  const std::int64_t begin_recorded = calls;
  engine(decay, recorder);
  counted.recorded = calls - begin_recorded;
  if (counted.recorded == 0) throw std::logic_error("allocations are not counted");
  return counted;
}

}  // namespace

std::vector<Allocations> count_allocations() {
  const Scene decay{.x0 = 6, .until_amplitude = 0.03};
  return {count_with("exact", checked(decay, Exact{}),
                     [](const Checked& run, auto& observer) { run_exact<double>(run, observer); }),
          count_with("restitution", checked(decay, Restitution{}),
                     [](const Checked& run, auto& observer) { run_restitution<double>(run, observer); })};
}

}  // namespace impact_damper::bench
