// What is made once for a scene, of its oscillators and its walls, compiled once for double.
#include "impact_damper/motion/contact_modes.hpp"

namespace impact_damper {

template DrivenSeriesTable<double>::DrivenSeriesTable(const Oscillator<double>&, const double&);
template ContactExponential<double>::ContactExponential(const ContactEquations<double>&);
template ContactModes<double, NoForcing<double>>::ContactModes(const System<double, NoForcing<double>>&,
                                                               const double&);
template ContactModes<double, Forcing<double>>::ContactModes(const System<double, Forcing<double>>&,
                                                             const double&);

}  // namespace impact_damper
