// The sections of a report's page about the regimes of a motion, and about the motion in its windows.
#include <algorithm>
#include <numeric>

#include "application/report/page.hpp"
#include "application/report/quantities.hpp"
#include "impact_damper/analysis/theory.hpp"

namespace impact_damper {
namespace {

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

}  // namespace

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
  const double lost = findings.energy_to_impacts() + findings.run.energy->viscous_work;
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
    const bool has_form = e > 0 && e < 1;
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
