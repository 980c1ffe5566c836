// SUNDIALS with root-finding: CVODE and ARKODE, the system as their callbacks see it, and the loop over its
// events.
#include <arkode/arkode_erkstep.h>
#include <cvode/cvode.h>
#include <nvector/nvector_serial.h>
#include <sundials/sundials_context.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>

#include <algorithm>
#include <stdexcept>
#include <string>

#include "contender.hpp"
#include "peers/hybrid_system.hpp"
#include "rows.hpp"

namespace impact_damper::bench {
namespace {

using System = HybridSystem<double>;

void require(int flag, const char* what) {
  if (flag < 0) throw std::runtime_error(std::string(what) + " failed with " + std::to_string(flag));
}

// What the callbacks are given. The solver's time begins anew with each regime, at `origin`: it locates roots
// to so many roundings of its time, and a contact late in a run is short beside the time since its start.
struct Problem {
  System system;
  double origin = 0;
};

System::State& state_of(N_Vector u) { return *reinterpret_cast<System::State*>(NV_DATA_S(u)); }

int derivative(realtype t, N_Vector u, N_Vector du, void* data) {
  const auto& problem = *static_cast<const Problem*>(data);
  problem.system.derivative(state_of(u), state_of(du), problem.origin + t);
  return 0;
}

int events(realtype t, N_Vector u, realtype* g, void* data) {
  const auto& problem = *static_cast<const Problem*>(data);
  for (std::size_t i = 0; i < System::events; ++i) {
    g[i] = problem.system.event(i, state_of(u), problem.origin + t);
  }
  return 0;
}

// Guards count where they fall, x and x' either way.
constexpr int directions[System::events] = {-1, -1, 0, 0};

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

// ARKODE (ERKStep): explicit Runge-Kutta steps, events on the interpolant. That is of the fifth degree at
// most, so Cash and Karp's fifth order goes further than more.
class Arkode {
 public:
  Arkode(Problem& problem, N_Vector u, SUNContext context, double tolerance, double radian)
      : memory_(ERKStepCreate(derivative, 0, u, context)) {
    // What it says on stderr of two roots near each other, see advance.
    require(ERKStepSetErrHandlerFn(
                memory_, [](int, const char*, const char*, char*, void*) {}, nullptr),
            "ERKStepSetErrHandlerFn");
    require(ERKStepSetUserData(memory_, &problem), "ERKStepSetUserData");
    require(ERKStepSStolerances(memory_, tolerance, tolerance), "ERKStepSStolerances");
    require(ERKStepSetTableNum(memory_, ARKODE_CASH_KARP_6_4_5), "ERKStepSetTableNum");
    require(ERKStepSetInterpolantType(memory_, ARK_INTERP_HERMITE), "ERKStepSetInterpolantType");
    require(ERKStepSetInterpolantDegree(memory_, 5), "ERKStepSetInterpolantDegree");
    require(ERKStepSetMaxNumSteps(memory_, 100'000'000), "ERKStepSetMaxNumSteps");
    require(ERKStepSetMaxStep(memory_, 0.25 * radian), "ERKStepSetMaxStep");
    require(ERKStepRootInit(memory_, System::events, events), "ERKStepRootInit");
    int ways[System::events];
    std::copy(std::begin(directions), std::end(directions), ways);
    require(ERKStepSetRootDirection(memory_, ways), "ERKStepSetRootDirection");
    require(ERKStepSetNoInactiveRootWarn(memory_), "ERKStepSetNoInactiveRootWarn");
  }
  ~Arkode() { ERKStepFree(&memory_); }
  Arkode(const Arkode&) = delete;

  bool advance(double end, N_Vector u, double& t) {
    int flag = ERKStepEvolve(memory_, end, u, &t, ARK_NORMAL);
    // Two roots so near each other that it does not go on: it is set out anew between them.
    if (flag == ARK_ILL_INPUT) {
      require(ERKStepReInit(memory_, derivative, t, u), "ERKStepReInit");
      flag = ERKStepEvolve(memory_, end, u, &t, ARK_NORMAL);
    }
    require(flag, "ERKStepEvolve");
    return flag == ARK_ROOT_RETURN;
  }
  void found(int* which) { require(ERKStepGetRootInfo(memory_, which), "ERKStepGetRootInfo"); }
  void restart(N_Vector u) { require(ERKStepReInit(memory_, derivative, 0, u), "ERKStepReInit"); }

 private:
  void* memory_;
};

// CVODE: Adams' methods: between two events the problem is not stiff, a contact is
// a half period of an oscillation to be followed, not damped away.
class Cvode {
 public:
  Cvode(Problem& problem, N_Vector u, SUNContext context, double tolerance, double radian)
      : memory_(CVodeCreate(CV_ADAMS, context)), solver_(SUNNonlinSol_FixedPoint(u, 0, context)) {
    require(CVodeInit(memory_, derivative, 0, u), "CVodeInit");
    require(CVodeSetUserData(memory_, &problem), "CVodeSetUserData");
    require(CVodeSStolerances(memory_, tolerance, tolerance), "CVodeSStolerances");
    require(CVodeSetNonlinearSolver(memory_, solver_), "CVodeSetNonlinearSolver");
    require(CVodeSetMaxNumSteps(memory_, 100'000'000), "CVodeSetMaxNumSteps");
    require(CVodeSetMaxStep(memory_, 0.1 * radian), "CVodeSetMaxStep");
    require(CVodeRootInit(memory_, System::events, events), "CVodeRootInit");
    int ways[System::events];
    std::copy(std::begin(directions), std::end(directions), ways);
    require(CVodeSetRootDirection(memory_, ways), "CVodeSetRootDirection");
    require(CVodeSetNoInactiveRootWarn(memory_), "CVodeSetNoInactiveRootWarn");
  }
  ~Cvode() {
    CVodeFree(&memory_);
    SUNNonlinSolFree(solver_);
  }
  Cvode(const Cvode&) = delete;

  bool advance(double end, N_Vector u, double& t) {
    const int flag = CVode(memory_, end, u, &t, CV_NORMAL);
    require(flag, "CVode");
    return flag == CV_ROOT_RETURN;
  }
  void found(int* which) { require(CVodeGetRootInfo(memory_, which), "CVodeGetRootInfo"); }
  void restart(N_Vector u) { require(CVodeReInit(memory_, 0, u), "CVodeReInit"); }

 private:
  void* memory_;
  SUNNonlinearSolver solver_;
};

}  // namespace

std::vector<Contender> cvode_peers() {
  return contenders<Cvode>("CVODE", "Adams with fixed-point iteration");
}

std::vector<Contender> arkode_peers() {
  return contenders<Arkode>("ARKODE", "ERKStep of Cash and Karp, fifth order");
}

}  // namespace impact_damper::bench
