// SUNDIALS ARKODE (ERKStep) with root-finding: explicit Runge-Kutta steps, events on the
// interpolant. That is of the fifth degree at most, so Cash and Karp's fifth order goes further than more.
#include <arkode/arkode_erkstep.h>

#include "peers/peers.hpp"
#include "peers/sundials.hpp"

namespace impact_damper::bench {
namespace {

using namespace sundials;

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

}  // namespace

std::vector<Contender> arkode_peers() {
  return contenders<Arkode>("ARKODE", "ERKStep of Cash and Karp, fifth order");
}

}  // namespace impact_damper::bench
