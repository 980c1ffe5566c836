// What CVODE and ARKODE share: the system as SUNDIALS' callbacks see it, and the loop over its events.
#pragma once

#include <nvector/nvector_serial.h>
#include <sundials/sundials_context.h>

#include <algorithm>
#include <stdexcept>
#include <string>

#include "peers/hybrid_system.hpp"
#include "peers/row_book.hpp"

namespace impact_damper::bench::sundials {

using System = HybridSystem<double>;

inline void require(int flag, const char* what) {
  if (flag < 0) throw std::runtime_error(std::string(what) + " failed with " + std::to_string(flag));
}

// What the callbacks are given. The solver's time begins anew with each regime, at `origin`: it locates roots
// to so many roundings of its time, and a contact late in a run is short beside the time since its start.
struct Problem {
  System system;
  double origin = 0;
};

inline System::State& state_of(N_Vector u) { return *reinterpret_cast<System::State*>(NV_DATA_S(u)); }

inline int derivative(realtype t, N_Vector u, N_Vector du, void* data) {
  const auto& problem = *static_cast<const Problem*>(data);
  problem.system.derivative(state_of(u), state_of(du), problem.origin + t);
  return 0;
}

inline int events(realtype t, N_Vector u, realtype* g, void* data) {
  const auto& problem = *static_cast<const Problem*>(data);
  for (std::size_t i = 0; i < System::events; ++i) {
    g[i] = problem.system.event(i, state_of(u), problem.origin + t);
  }
  return 0;
}

// Guards count where they fall, x and x' either way.
inline constexpr int directions[System::events] = {-1, -1, 0, 0};

struct Context {
  SUNContext context = nullptr;
  Context() { require(SUNContext_Create(nullptr, &context), "SUNContext_Create"); }
  ~Context() { SUNContext_Free(&context); }
};
struct Vector {
  N_Vector vector;
  Vector(const System::State& from, SUNContext context) : vector(N_VNew_Serial(System::events, context)) {
    state_of(vector) = from;
  }
  ~Vector() { N_VDestroy(vector); }
  Vector(const Vector&) = delete;
};

// Solver(problem, u, context, tolerance, time by radian of the fastest motion), with restart(u) at its time
// 0, advance(end, u, t) that says whether it stopped at an event, and found(events).
template <class Solver>
Rows run(const Scene& scene, Walls walls, double tolerance) {
  const Context context;
  Problem problem{System(scene, walls)};
  const Vector vector(problem.system.state, context.context);
  N_Vector u = vector.vector;
  // Roots are looked for at the ends of steps only, whose length is bounded by the shorter of the two
  // periods.
  const double radian = scene.force_amplitude != 0 ? 1 / std::max(1.0, scene.force_frequency) : 1;
  Solver solver(problem, u, context.context, tolerance, radian);

  RowBook rows(scene.x0, scene.until_amplitude);
  const double end = scene.until_time ? *scene.until_time : 1e6;
  double t = 0;
  while (solver.advance(end - problem.origin, u, t)) {
    int found[System::events];
    solver.found(found);
    const double now = problem.origin + t;
    rows.peak(now, state_of(u)[0]);
    if (found[2] && rows.zero_crossing(now)) break;
    for (std::size_t guard = 0; guard < System::guards; ++guard) {
      if (!found[guard]) continue;
      if (problem.system.pass(guard, state_of(u), now)) rows.impact();
      problem.origin = now;
      t = 0;
      solver.restart(u);
      break;
    }
  }
  return rows.finish();
}

// A contender for each kind of wall.
template <class Solver>
std::vector<Contender> contenders(const std::string& name, const std::string& about) {
  std::vector<Contender> all;
  for (const Walls walls : {Walls::compliant, Walls::rigid}) {
    all.push_back(
        {name, walls, "tolerance", [](const Scene&) { return geometric(1e-4, 0.1, 11); },
         [walls](const Scene& scene, double tolerance) { return run<Solver>(scene, walls, tolerance); },
         about + ", root-finding; SUNDIALS " SUNDIALS_VERSION});
  }
  return all;
}

}  // namespace impact_damper::bench::sundials
