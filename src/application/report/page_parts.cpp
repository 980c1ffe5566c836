// The sections of a report's page about what the motion does: its summary, decay, loss factor, regimes,
// motion, energy, loads and predictability.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "application/report/page.hpp"
#include "application/report/quantities.hpp"
#include "impact_damper/analysis/design.hpp"
#include "impact_damper/analysis/theory.hpp"
#include "impact_damper/math/elementary.hpp"

namespace impact_damper {
namespace {

std::string part_in_words(double part) {
  return part == 0.5 ? "half" : part == 0.1 ? "a tenth" : "a hundredth";
}

// Returns "0.1 to 0.2", or one of them where a reader would see no difference.
std::string range_html(const std::string& low, const std::string& high) {
  return without_tags(low) == without_tags(high) ? high : low + " to " + high;
}

// A loss factor beyond the closed forms, which assume that the amplitude changes little from peak to peak.
constexpr double far_too_much = 0.5;

// Returns the equivalent viscous damping ratio in words: that of an oscillator with this loss factor.
std::string as_viscous(double eta) { return "a viscous damping ratio of " + percent_html(eta / 2); }

std::string fall_in_short(const Findings& findings) {
  const Quantities quantities(findings.subject.scales);
  constexpr double hardly = 0.999;
  const double first = *findings.first_amplitude, last = findings.last_amplitude;
  const std::string from = "From an amplitude of " + quantities.length(first) + " the motion ";
  if (findings.falls.size() > 1)
    return from + "falls to a tenth within " + quantities.time(findings.falls[1].time - findings.first_peak) +
           ". ";
  if (!(last < hardly * first)) return from + "hardly falls within this run. ";
  return from + "falls to " + quantities.length(last) + " by the end of the run. ";
}

std::string steady_sentence(const Findings& findings) {
  const Quantities quantities(findings.subject.scales);
  if (!findings.steady)
    return "The run is too short to speak of a steady motion: it has " +
           count_html(std::ssize(findings.run.half_cycles->amplitude)) + " half cycles.";
  const SteadyAmplitude& steady = *findings.steady;
  const std::string least = quantities.length(steady.least), greatest = quantities.length(steady.greatest);
  std::string text = "In the last quarter of the run the amplitude is ";
  text += without_tags(least) == without_tags(greatest)
              ? greatest + ". "
              : greatest + " at most, " + quantities.length(steady.mean) + " on average and " + least +
                    " at least. ";
  if (!steady.settled) text += "It is not settled: it still changes from quarter to quarter of the run. ";
  return text;
}

std::string falls_table(const Findings& findings) {
  const Quantities quantities(findings.subject.scales);
  HtmlTable table{
      .caption = "When the amplitude first was below a part of the first one, counted from the first peak",
      .heads = {"Below", "that is", "within"}};
  if (!findings.others.empty()) table.heads.emplace_back("of all releases");
  const auto since = [&](double time) { return quantities.time(time - findings.first_peak); };
  for (const Fall& fall : findings.falls) {
    table.rows.push_back({part_in_words(fall.part), quantities.length(fall.amplitude), since(fall.time)});
    if (findings.others.empty()) continue;
    table.rows.back().push_back(fall.times ? range_html(since(fall.times->low), since(fall.times->high))
                                           : "not all get there");
  }
  return table_html(table);
}

std::string best_sentences(const Findings& findings) {
  const Quantities quantities(findings.subject.scales);
  const BestDamping& best = *findings.best;
  const double zeta = findings.subject.scene.damping_ratio;
  const LogarithmicFit fit;
  std::string text =
      "The loss factor η is the part of the energy lost per radian. It is the slope of a straight line "
      "through the logarithm of 3 to " +
      count_html(fit.most_half_cycles + 1) + " successive peaks, no more than lie within a factor of " +
      number_html(fit.factor) + " of each other. " +
      (findings.several() ? "Before the impacts of all fail it is largest, "
                          : "Before impacts fail it is largest, ") +
      number_html(best.eta) + ", at an amplitude of " + quantities.length(best.amplitude) +
      ": the primary mass is damped there as by " + as_viscous(best.eta) + ". ";
  if (zeta > 0) text += "Its own damping accounts for η = 2ζ = " + number_html(2 * zeta) + " of that. ";
  if (best.etas && best.etas->low < best.etas->high)
    text += "Over all releases it is " +
            range_html(number_html(best.etas->low), number_html(best.etas->high)) + ", at " +
            range_html(quantities.length(best.amplitudes->low), quantities.length(best.amplitudes->high)) +
            ". ";
  const bool failed = findings.failure.first_missed || findings.failure.for_good;
  if (!failed && best.row + 1 == findings.loss.eta.size())
    text += "It is found at the end of the run: further down the damping may be better still. ";
  return text;
}

std::string theory_sentences(const Findings& findings) {
  const Quantities quantities(findings.subject.scales);
  const Scene& scene = findings.subject.scene;
  const double e = scene.damper().restitution;
  if (e == 1)
    return "With <i>e</i> = 1 impacts lose no energy, they only hand it to the secondary mass and back.";
  if (e == 0)
    return "With <i>e</i> = 0 there is no rebound, and the closed forms for other restitutions do not hold.";
  const double eta = peak_loss(e) * scene.damper().mass_ratio + 2 * scene.damping_ratio;
  std::string text =
      "For a light mass that strikes once in each half cycle there is a closed form: impacts damp best at an "
      "amplitude of " +
      quantities.length(peak_loss_amplitude(e)) + ", (1 − <i>e</i>)/(1 + <i>e</i>)/π of the clearance";
  if (eta < far_too_much) text += ", with η = " + number_html(eta);
  text += ". ";
  const BestDamping& best = *findings.best;
  if (const auto motion = single_impact(e, best.amplitude);
      motion && eta < far_too_much && best.amplitude < equal_spacing_amplitude(e))
    text += "Where this run is damped best it gives η = " +
            number_html(motion->loss * scene.damper().mass_ratio + 2 * scene.damping_ratio) +
            " in place of " + number_html(best.eta) +
            ": it holds for a steady amplitude, behind which a heavier secondary mass lags. ";
  return text + "The best amplitude is " + percent_html(peak_loss_amplitude(e) / fold_amplitude(e) - 1) +
         " above " + quantities.length(fold_amplitude(e)) +
         ", where this motion ceases: below, impacts fail and only the primary mass's own damping is left.";
}

std::string clearance_html(const Findings& findings) {
  const Quantities quantities(findings.subject.scales);
  const Scene& scene = findings.subject.scene;
  if (!(scene.damper().restitution > 0 && scene.damper().restitution < 1)) return "";
  const Tolerances tolerances;
  const ClearanceRule rule = clearance_rule(scene.damper().restitution, tolerances);
  const auto percent = [](double part) { return number_html(100 * part) + " %"; };
  const std::string text =
      "To damp a given amplitude choose a clearance of " + number_html(1 / rule.amplitude) +
      " times that amplitude: it is then " + number_html(rule.margin) +
      " times the one at which impacts fail. So far may <i>e</i> be " + number_html(tolerances.restitution) +
      " lower, the clearance " + percent(tolerances.clearance) + " wider and the amplitude " +
      percent(tolerances.amplitude) +
      " smaller than thought, all at once. This scene's clearance is right for " +
      quantities.length(rule.amplitude) +
      ". All this is for a secondary mass without friction: one that slides damps nothing below the "
      "amplitude "
      "at which friction holds it, whatever the clearance.";
  HtmlTable table{.caption = "The amplitude, in units of the clearance, beside the one at which impacts fail",
                  .heads = {"Clearance", "amplitude", "impacts fail at", "margin"}};
  const bool light = peak_loss(scene.damper().restitution) * scene.damper().mass_ratio < far_too_much;
  if (light) table.heads.emplace_back("η of the impacts");
  const auto row = [&](const std::string& what, double amplitude, double fold, double loss) {
    table.rows.push_back({what, number_html(amplitude), number_html(fold), number_html(amplitude / fold)});
    if (light) table.rows.back().push_back(number_html(loss * scene.damper().mass_ratio));
  };
  const double e = scene.damper().restitution;
  row("for the best damping, without a margin", peak_loss_amplitude(e), rule.fold, peak_loss(e));
  row("recommended", rule.amplitude, rule.fold, rule.loss);
  row("recommended, all tolerances at their worst", rule.worst_amplitude, rule.worst_fold, rule.worst_loss);
  return paragraph_html(text) + table_html(table);
}

std::string impacts_in_words(std::int64_t impacts) {
  return count_html(impacts) + (impacts == 1 ? " impact" : " impacts") + " in every half cycle";
}

std::string impacts_counted(const Findings& findings) {
  const auto count = std::ssize(findings.run.impacts->time);
  return count == 0 ? "there are no impacts"
                    : count_html(count) + (count == 1 ? " impact was" : " impacts were") + " counted";
}

std::string regime_table(const Findings& findings) {
  const Quantities quantities(findings.subject.scales);
  HtmlTable table{.caption = "Regimes found, by the amplitudes between which each lasts",
                  .heads = {"Regime", "from", "to", "half cycles"}};
  if (findings.sticking_ends && !findings.forced()) {
    const auto& [row, amplitude] = *findings.sticking_ends;
    table.rows.push_back({"bounces that end stuck to a wall", quantities.length(*findings.first_amplitude),
                          quantities.length(amplitude), count_html(static_cast<std::int64_t>(row + 1))});
  }
  for (const RegularWindow& window : findings.windows)
    table.rows.push_back({impacts_in_words(window.impacts), quantities.length(window.upper),
                          quantities.length(window.lower),
                          count_html(static_cast<std::int64_t>(window.last - window.first + 1))});
  return table.rows.empty() ? "" : table_html(table);
}

std::string sticking_sentence(const Findings& findings) {
  const Quantities quantities(findings.subject.scales);
  if (!(findings.stuck_time > 0)) return "The secondary mass never sticks to a wall. ";
  std::string share = "The secondary mass is stuck to a wall for " +
                      percent_html(findings.stuck_time / findings.run.end_time) + " of the time. ";
  if (findings.forced()) return share;
  if (findings.sticking_ends)
    return share + "Down to an amplitude of " + quantities.length(findings.sticking_ends->amplitude) +
           " its bounces on a wall die out before the primary mass has come back, half cycle after half "
           "cycle; there sticking ends. ";
  return share + "It does so only now and then, or to the end of the run. ";
}

std::string failure_sentence(const Findings& findings) {
  const Quantities quantities(findings.subject.scales);
  if (findings.forced()) return "";
  const auto& [missed, for_good] = findings.failure;
  if (missed) {
    const std::string text = "Impacts begin to fail at an amplitude of " +
                             quantities.length(missed->amplitude) +
                             ": from there on a half cycle may pass without one";
    if (!for_good) return text + ". ";
    return text + (for_good->row == missed->row
                       ? ", and they do not recover. "
                       : ", and below " + quantities.length(for_good->amplitude) + " they do not recover. ");
  }
  if (for_good)
    return "From an amplitude of " + quantities.length(for_good->amplitude) +
           " on, to the end of the run, there are fewer impacts than half cycles. ";
  return "Impacts do not begin to fail within this run. ";
}

std::string strikes(const Findings& findings, std::size_t damper, const MotionWindow& window) {
  const Run run = findings.run_of(damper);
  const std::vector<double>& time = run.history->time;
  const std::vector<double>& impacts = run.impacts->time;
  const std::string who = findings.several() ? "damper " + std::to_string(damper + 1) : "the secondary mass";
  const auto count = std::ranges::upper_bound(impacts, time[window.last]) -
                     std::ranges::lower_bound(impacts, time[window.first]);
  if (count == 0) return who + " does not strike a wall. ";
  return who + " strikes a wall " + (count == 1 ? "once. " : count_html(count) + " times. ");
}

// Returns a sentence on what remains of the result if the masses slide; none if the page assumes nothing.
std::string friction_in_short(const Findings& findings) {
  if (findings.frictions.empty()) return "";
  const Quantities quantities(findings.subject.scales);
  const FrictionFindings& without = findings.frictions.front();
  const FrictionFindings& typical = findings.frictions[2];
  const std::string it = findings.several() ? "they" : "it";
  std::string text =
      "This is for " +
      std::string(findings.several() ? "secondary masses that move" : "a secondary mass that moves") +
      " without friction, as on rollers. If " + it + " slid with a coefficient of " +
      number_html(typical.coefficient) + ", ";
  text += typical.last_impact ? "the last impact would be at an amplitude of " +
                                    quantities.length(typical.last_impact->amplitude)
                              : it + " would never strike a wall";
  const bool steady = typical.steady && without.steady;
  const auto amplitude = [&](const FrictionFindings& its) {
    return quantities.length(steady ? its.steady->greatest : its.last_amplitude);
  };
  return paragraph_html(text + ", and the amplitude " +
                        (steady ? "in the last quarter of the run at most " : "at the end of the run ") +
                        amplitude(typical) + " in place of " + amplitude(without) + ".");
}

}  // namespace

std::string summary_html(const Findings& findings) {
  const Quantities quantities(findings.subject.scales);
  if (!findings.first_amplitude)
    return paragraph_html(
        "The primary mass never swings through its position of rest within this run, so there is no "
        "amplitude to speak of: only its motion and its energy are shown.");
  std::string text = findings.forced() ? response_in_short(findings) : fall_in_short(findings);
  if (findings.best)
    text += "It is damped best at an amplitude of " + quantities.length(findings.best->amplitude) +
            ", as by " + as_viscous(findings.best->eta) + ". ";
  const double impacts = findings.energy_to_impacts(), lost = findings.energy_lost();
  if (findings.run.impacts->time.empty())
    text += "There is no impact at all.";
  else if (lost > 0)
    text += "Impacts took " + percent_html(impacts / lost) + " of the energy that was lost.";
  if (const auto last = last_with_impact(*findings.run.half_cycles);
      last && has_components(findings.subject.scene))
    text += " The last one is at an amplitude of " + quantities.length(last->amplitude) + ", and " +
            quantities.length(findings.last_amplitude) + " are left at the end of the run.";
  return paragraph_html(text) + friction_in_short(findings);
}

std::string friction_html(const Findings& findings) {
  if (findings.frictions.empty()) return "";
  const Quantities quantities(findings.subject.scales);
  const bool forced = findings.forced();
  HtmlTable table{.caption = "What sliding would change: the same run, of " +
                             quantities.time(findings.run.end_time) + ", with friction",
                  .heads = {"Coefficient of friction"}};
  const std::vector<std::string> heads =
      forced ? std::vector<std::string>{"largest amplitude of the last quarter", "mean amplitude there"}
             : std::vector<std::string>{"a tenth of the amplitude within", "damped best at",
                                        "as by a viscous damping ratio of"};
  table.heads.insert(table.heads.end(), heads.begin(), heads.end());
  table.heads.insert(table.heads.end(), {"last impact at an amplitude of", "after", "amplitude at the end"});
  for (const FrictionFindings& each : findings.frictions) {
    std::vector<std::string>& row = table.rows.emplace_back();
    const auto add = [&](bool is_there, auto&& cell) { row.push_back(is_there ? cell() : std::string("–")); };
    row = {each.coefficient == 0 ? "none" : number_html(each.coefficient)};
    if (!each.is_whole) row.front() += ", given up";
    if (forced) {
      add(each.steady.has_value(), [&] { return quantities.length(each.steady->greatest); });
      add(each.steady.has_value(), [&] { return quantities.length(each.steady->mean); });
    } else {
      add(each.to_tenth.has_value(), [&] { return quantities.time(*each.to_tenth); });
      add(each.best.has_value(), [&] { return quantities.length(*each.best); });
      add(each.best.has_value(), [&] { return percent_html(*each.best_eta / 2); });
    }
    add(each.last_impact.has_value(), [&] { return quantities.length(each.last_impact->amplitude); });
    add(each.last_impact.has_value(), [&] { return quantities.time(each.last_impact_time); });
    row.push_back(quantities.length(each.last_amplitude));
  }
  return table_html(table);
}

std::string decay_html(const Findings& findings) {
  const Quantities quantities(findings.subject.scales);
  if (!findings.first_amplitude)
    return paragraph_html("The run holds not one whole half cycle: there is no amplitude to follow.");
  if (findings.forced()) return paragraph_html(steady_sentence(findings));
  const double time = findings.last_peak - findings.first_peak;
  const double fallen = *findings.first_amplitude / findings.last_amplitude;
  std::string html =
      !findings.falls.empty()
          ? falls_table(findings)
          : paragraph_html(
                "Within this run the amplitude does not fall to half of its first value; it ends at " +
                quantities.length(findings.last_amplitude) + ", " + percent_html(1 / fallen) + " of it.");
  if (time > 0 && std::isfinite(fallen) && fallen > 1)
    html += paragraph_html(
        "Over the whole run the amplitude fell as that of an oscillator with a viscous damping ratio of " +
        percent_html(logarithm(fallen) / time) + " would have" +
        (findings.best ? "; but impacts do not damp evenly, as the next section shows." : "."));
  return html;
}

std::string loss_html(const Findings& findings) {
  if (!findings.first_amplitude)
    return paragraph_html("Without half cycles there is no loss factor to read off.");
  const Scene& scene = findings.subject.scene;
  const bool ideal = is_ideal(scene);
  if (findings.best) {
    const std::string best = paragraph_html(best_sentences(findings));
    if (!ideal)
      return best + paragraph_html(
                        "The closed forms for the best clearance are for a secondary mass " +
                        std::string(has_components(scene)
                                        ? "without friction, weight and drag"
                                        : "of one restitution, between linear walls and on a linear spring") +
                        ": here they recommend none.");
    return best +
           (findings.several() ? "" : paragraph_html(theory_sentences(findings)) + clearance_html(findings));
  }
  if (findings.run.impacts->time.empty() && has_components(scene))
    return paragraph_html(
        "There is no impact: what damps is viscous damping, and friction and drag in the "
        "cavity where the secondary mass slides.");
  if (findings.run.impacts->time.empty())
    return paragraph_html("Without impacts the loss factor is that of viscous damping alone, η = 2ζ = " +
                          number_html(2 * scene.damping_ratio) + ", at every amplitude.");
  if (findings.loss.eta.empty())
    return paragraph_html(
        "The loss factor is read off three successive peaks or more, each of a whole half cycle before "
        "impacts fail, and this run is too short for that: let it go further, by a later or a lower stop.");
  return paragraph_html(
      !findings.several() && scene.damper().restitution == 1
          ? "With <i>e</i> = 1 and without viscous damping nothing is ever lost: there is no loss factor."
          : "The amplitude does not fall: there is no loss factor to speak of.");
}

std::string energy_html(const Findings& findings) {
  const EnergyBalance& balance = *findings.run.energy;
  const double brought = balance.initial.total() + std::max(0.0, balance.forcing_work);
  const double impacts = findings.energy_to_impacts();
  const auto& scales = findings.subject.scales;
  HtmlTable table{.caption = findings.several()
                                 ? "The energy of all masses, from the beginning to the end of the run"
                                 : "The energy of both masses, from the beginning to the end of the run",
                  .heads = {"What"}};
  if (scales) table.heads.emplace_back("J");
  table.heads.insert(table.heads.end(), {"in units of Kε²", "share"});
  const auto row = [&](const std::string& what, double energy) {
    table.rows.push_back({what});
    if (scales) table.rows.back().push_back(number_html(energy * scales->of(Dimension::energy), 4));
    table.rows.back().push_back(number_html(energy, 4));
    table.rows.back().push_back(brought > 0 ? percent_html(energy / brought) : "");
  };
  row("At the beginning", balance.initial.total());
  if (findings.forced()) row("Brought by the exciting force", balance.forcing_work);
  row("Taken by impacts", impacts);
  row("Taken by viscous damping", balance.viscous_work);
  if (balance.friction_loss != 0) row("Taken by friction in the cavity", balance.friction_loss);
  if (balance.drag_loss != 0) row("Taken by drag in the cavity", balance.drag_loss);
  row("Left at the end", balance.final.total());

  std::string text = "There are no impacts. ";
  if (!findings.run.impacts->time.empty())
    text = impacts_counted(findings) +
           (impacts > 0 && brought > 0
                ? ", which took " + percent_html(impacts / brought) + " of the energy at the beginning" +
                      (findings.forced() ? " and of what the force brought. " : ". ")
                : ". ");
  return table_html(table) +
         paragraph_html(
             text + (balance.residual == 0
                         ? "All of it adds up, to the last digit."
                         : "When all are added up, " + number_html(balance.residual) +
                               " of the energy that went through is left over: " +
                               (std::holds_alternative<Cem>(findings.run.engine) ? "the error of the steps."
                                                                                 : "rounding.")));
}

std::string loads_html(const Findings& findings) {
  const Quantities quantities(findings.subject.scales);
  const Scene& scene = findings.subject.scene;
  if (!findings.loads)
    return paragraph_html("There is no impact in this run, so there is nothing for the walls to bear.");
  const Loads& loads = *findings.loads;
  const auto& scales = findings.subject.scales;
  HtmlTable table{.caption = findings.several() ? "Loads of the boxes and of the secondary masses in this run"
                                                : "Loads of the box and of the secondary mass in this run",
                  .heads = {"What", "how much"}};
  const auto row = [&](const std::string& what, const std::string& value) {
    table.rows.push_back({what, value});
  };
  row(findings.several() ? "Largest impact speed of a damper, relative" : "Largest impact speed, relative",
      quantities.velocity(loads.speed));
  constexpr double per_hour = 3600;
  const double rate = loads.impacts / loads.time;
  row(findings.forced() ? "Impacts, in the last quarter of the run" : "Impacts, on average over the run",
      scales ? number_html(rate * per_hour / scales->of(Dimension::time)) + " in an hour"
             : number_html(2 * std::numbers::pi * rate) + " in a period 2π/Ω");
  std::string text;
  if (loads.contact) {
    row("Largest force of a wall, in that impact", quantities.force(loads.contact->force));
    row("Duration of a contact", loads.contact->duration ? quantities.duration(*loads.contact->duration)
                                                         : "the mass does not rebound");
    text =
        "Force and duration depend on the stiffness of the walls <i>k</i>, the force as √<i>k</i>, the "
        "duration as 1/√<i>k</i>; the speed and the number of impacts hardly do. ";
    text += "Here <i>k</i> = " + number_html(scene.damper().wall_stiffness) + " times the primary stiffness" +
            (scales ? ", " + number_html(scene.damper().wall_stiffness * scales->stiffness) + " N/m" : "");
    text +=
        scene.damper().wall_stiffness == SceneDamper{}.wall_stiffness
            ? ": this is the program's default, an assumption. Give the stiffness of your own walls (<code>" +
                  std::string(scales ? "contact_stiffness" : "wall_stiffness") +
                  "</code>) before you use these two. "
            : ". ";
  } else if (findings.several()) {
    text = "What each damper has to bear is in the table of the dampers. ";
  } else if (has_rigid_walls(findings.subject.engine)) {
    text =
        "The walls of this engine are rigid and impacts take no time: the force and the duration of a "
        "contact follow from the stiffness of the walls" +
        (has_laws(scene) ? "" : ", with the engine <code>" + std::string(Exact::name) + "</code>") + ". ";
  } else if (scene.damper().wall.law != WallForm::linear) {
    text = "The walls have a law of their own: there is no closed form for the force of a contact. ";
  } else {
    text =
        "The walls are so soft that a contact lasts a good part of a period: there is no closed form for its "
        "force. ";
  }
  if (loads.initial_force > 0)
    row("Force of the wall in which the run begins", quantities.force(loads.initial_force));
  return table_html(table) + paragraph_html(text);
}

std::string prediction_html(const Findings& findings) {
  const Quantities quantities(findings.subject.scales);
  if (findings.others.empty())
    return paragraph_html(
        "Only one release was simulated (<code>--members 1</code>), so nothing can be said about how far "
        "small differences grow.");
  if (findings.spread.empty()) return paragraph_html("There is no amplitude of which a spread can be given.");
  const EnsembleOptions shifts;
  const std::string text = count_html(std::ssize(findings.others) + 1) + " releases that differ by at most " +
                           number_html(100 * shifts.step * static_cast<double>(shifts.most_steps)) +
                           " % were followed. ";
  const double greatest = std::ranges::max(findings.spread), last = findings.spread.back();
  if (!findings.lost_row)
    return paragraph_html(text + "Their amplitudes never part by more than " + percent_html(greatest) +
                          ": within this run the motion can be predicted.");
  const HalfCycles& rows = *findings.run.half_cycles;
  const std::string agreement =
      *findings.lost_row == 0
          ? "Not even their first amplitudes agree within " + percent_html(lost_spread)
          : "Up to an amplitude of " + quantities.length(rows.amplitude[*findings.lost_row - 1]) + ", " +
                quantities.time(rows.peak_time[*findings.lost_row - 1]) +
                " after the release, they agree within " + percent_html(lost_spread);
  return paragraph_html(
      text + agreement +
      "; then these differences have grown beyond that, as they do where the motion is chaotic, and no "
      "single run gives the amplitude at a given time any better. The greatest spread is " +
      percent_html(greatest) + ", the last " + percent_html(last) + ".");
}

std::string motion_html(const Findings& findings) {
  if (!findings.begin) return paragraph_html("The run ends where it begins: there is no motion to show.");
  const Quantities quantities(findings.subject.scales);
  const std::vector<double>& time = findings.run.history->time;
  std::string text;
  if (findings.several()) {
    text = "Chosen is the damper that took most of the energy, number " + std::to_string(findings.shown + 1);
    if (findings.chosen) text += ", and about the best damping the one that strikes most often then";
    text += "; dimensionless lengths are divided by its clearance. ";
  }
  text += "In the first " + quantities.time(time[findings.begin->last]) + " " +
          strikes(findings, findings.shown, *findings.begin);
  if (findings.chosen)
    text += (findings.forced() ? "At the end, from " : "About the best damping, from ") +
            quantities.time(time[findings.chosen->first]) + " to " +
            quantities.time(time[findings.chosen->last]) + ", " +
            strikes(findings, findings.shown_when_chosen, *findings.chosen);
  return paragraph_html(text);
}

std::string regimes_html(const Findings& findings) {
  if (!findings.first_amplitude)
    return paragraph_html("Without half cycles there are no regimes to tell apart; " +
                          impacts_counted(findings) + ".");
  if (findings.run.impacts->time.empty())
    return paragraph_html(
        "The secondary mass never strikes a wall: the primary mass moves too little for that, or too "
        "slowly.");
  std::string text = sticking_sentence(findings);
  text += findings.most_impacts == 1
              ? "No half cycle has more than one impact. "
              : "There are up to " + count_html(findings.most_impacts) + " impacts in one half cycle. ";
  if (findings.windows.empty())
    text += "Their number is nowhere the same for " + count_html(RegimeOptions{}.window_half_cycles) +
            " half cycles in a row. ";
  return paragraph_html(text + failure_sentence(findings)) + regime_table(findings);
}

std::string dampers_html(const Findings& findings) {
  const Quantities quantities(findings.subject.scales);
  const Scene& scene = findings.subject.scene;
  const double lost = findings.energy_lost();
  HtmlTable table{.caption = "What each damper did, in the order of the scene file",
                  .heads = {"Damper", "clearance", "damps best at", "fails at"}};
  const bool rigid = has_rigid_walls(findings.subject.engine), free = !findings.forced();
  if (free) table.heads.emplace_back("failed at");
  for (const char* each : {"energy taken", "impacts", "largest speed"}) table.heads.emplace_back(each);
  if (!rigid) table.heads.emplace_back("largest force");
  for (std::size_t n = 0; n < scene.dampers.size(); ++n) {
    const SceneDamper& damper = scene.dampers[n];
    const DamperFindings& found = findings.dampers[n];
    const double e = damper.restitution, c = damper.clearance;
    const bool has_form = e > 0 && e < 1 && is_ideal(scene);
    const auto& [missed, for_good] = found.failure;
    const auto failed = missed ? missed : for_good;
    std::vector<std::string>& row = table.rows.emplace_back();
    const auto add = [&](bool is_there, auto&& cell) { row.push_back(is_there ? cell() : std::string("–")); };
    row = {std::to_string(n + 1), quantities.length(c)};
    add(has_form, [&] { return quantities.length(peak_loss_amplitude(e) * c); });
    add(has_form, [&] { return quantities.length(fold_amplitude(e) * c); });
    if (free) add(failed.has_value(), [&] { return quantities.length(failed->amplitude); });
    add(lost > 0, [&] { return percent_html(found.energy / lost); });
    row.push_back(count_html(found.impacts));
    add(found.loads.has_value(), [&] { return quantities.velocity(found.loads->speed); });
    if (rigid) continue;
    add(found.loads && found.loads->contact,
        [&] { return quantities.force(std::max(found.loads->contact->force, found.loads->initial_force)); });
  }
  std::string text =
      "<i>Damps best at</i> and <i>fails at</i> are amplitudes by the closed form for a light mass that "
      "strikes once in each half cycle; a damper that fails strikes only now and then, and loses little. The "
      "energy is that part of all that was lost which its impacts took.";
  if (free) text += " <i>Failed at</i> is where its impacts began to fail in this run.";
  if (const auto& stuck = findings.dampers[findings.shown].sticking_ends; free && stuck)
    text += " The bounces of damper " + std::to_string(findings.shown + 1) +
            ", which took most, ended stuck to a wall down to an amplitude of " +
            quantities.length(stuck->amplitude) + ".";
  const auto has_default = [](const SceneDamper& damper) {
    return damper.wall_stiffness == SceneDamper{}.wall_stiffness;
  };
  if (!rigid && std::ranges::any_of(scene.dampers, has_default))
    text += " The force goes as √<i>k</i>, and a stiffness of " + number_html(SceneDamper{}.wall_stiffness) +
            " times the primary one is the program's default, an assumption: give that of your own walls.";
  return table_html(table) + paragraph_html(text);
}

}  // namespace impact_damper
