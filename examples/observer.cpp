// An engine with an observer of one's own. It keeps only the number of impacts and the longest contact, so
// its memory does not grow with the length of the run.
#include <cstdio>
#include <limits>

#include "impact_damper/engines/exact.hpp"

// What an engine asks its observer, and reports to it: RunObserver in engines/observer.hpp. An engine
// computes only what is wanted, except impacts, which it always reports.
struct LongestContact {
  bool wants_half_cycles() const { return false; }
  bool wants_contacts() const { return true; }
  bool wants_energy() const { return false; }
  double next_sample() const { return std::numeric_limits<double>::infinity(); }  // never

  void half_cycle(double, double, double, double) {}
  void impact(double, impact_damper::Wall, double, double) { ++impacts; }
  void contact(double begins, double ends, impact_damper::Wall) {
    if (ends - begins > longest) begin = begins, longest = ends - begins;
  }
  void sample(double, double, double, double, double) {}
  impact_damper::EnergyBalance& energy_balance() { return unused; }

  int impacts = 0;
  double begin = 0, longest = 0;
  impact_damper::EnergyBalance unused;
};

int main() {
  impact_damper::Scene scene;  // the paper's: mass ratio 0.02, restitution 0.6, released at 6 clearances
  scene.until_amplitude = 0.1;
  const auto run = impact_damper::checked(scene, impact_damper::Exact{});  // throws where simulate() does

  LongestContact observer;
  const auto outcome = impact_damper::run_exact<double>(run, observer);
  std::printf("%d impacts until t = %.3f\n", observer.impacts, outcome.end_time);
  std::printf("the longest contact begins at t = %.3f and lasts %.6f\n", observer.begin, observer.longest);
}
