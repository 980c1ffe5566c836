// SUNDIALS CVODE with root-finding. Adams' methods: between two events the problem is not stiff, a contact is
// a half period of an oscillation to be followed, not damped away.
#include <cvode/cvode.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>

#include "peers/peers.hpp"
#include "peers/sundials.hpp"

namespace impact_damper::bench {
namespace {

using namespace sundials;

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

}  // namespace impact_damper::bench
