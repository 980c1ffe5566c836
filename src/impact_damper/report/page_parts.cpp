#include "impact_damper/report/page_parts.hpp"

#include <algorithm>
#include <cmath>

#include "impact_damper/analysis/theory.hpp"
#include "impact_damper/motion/elementary.hpp"
#include "impact_damper/report/speech.hpp"

namespace impact_damper {
namespace {

std::string part_in_words(double part) {
  return part == 0.5 ? "half" : part == 0.1 ? "a tenth" : "a hundredth";
}

// What is read of a text with numbers in it: equal for numbers that differ in digits not shown.
std::string shown(const std::string& html) {
  std::string text;
  bool in_tag = false;
  for (const char c : html) {
    if (c == '<') in_tag = true;
    if (!in_tag) text += c;
    if (c == '>') in_tag = false;
  }
  return text;
}

// "0.1 to 0.2", or one of them where a reader would see no difference.
std::string range_html(const std::string& low, const std::string& high) {
  return shown(low) == shown(high) ? high : low + " to " + high;
}

// An equivalent viscous damping ratio: that of an oscillator with this loss factor.
std::string as_viscous(double eta) { return "a viscous damping ratio of " + percent_html(eta / 2); }

std::string fall_in_short(const Findings& findings) {
  const Speech speech(findings.subject.scales);
  constexpr double hardly = 0.999;
  const double first = *findings.first_amplitude, last = findings.last_amplitude;
  const std::string from = "From an amplitude of " + speech.length(first) + " the motion ";
  if (findings.falls.size() > 1)
    return from + "falls to a tenth within " + speech.time(findings.falls[1].time - findings.first_peak) +
           ". ";
  if (!(last < hardly * first)) return from + "hardly falls within this run. ";
  return from + "falls to " + speech.length(last) + " by the end of the run. ";
}

std::string steady_sentences(const Findings& findings) {
  const Speech speech(findings.subject.scales);
  if (!findings.steady)
    return "The run is too short to speak of a steady motion: it has " +
           count_html(std::ssize(findings.run.half_cycles->amplitude)) + " half cycles.";
  const SteadyState& steady = *findings.steady;
  const std::string text = "In the last quarter of the run the amplitude lies between " +
                           speech.length(steady.least) + " and " + speech.length(steady.greatest) + ", " +
                           speech.length(steady.mean) + " on average. With the loose mass taken out ";
  if (steady.without_impacts)
    return text + "the same force would hold the primary mass at " + speech.length(*steady.without_impacts) +
           ".";
  return text +
         "the amplitude would grow without end: the force meets the undamped primary mass at its natural "
         "frequency.";
}

std::string falls_table(const Findings& findings) {
  const Speech speech(findings.subject.scales);
  HtmlTable table{
      .caption = "When the amplitude first was below a part of the first one, counted from the first peak",
      .heads = {"Below", "that is", "within"},
      .rows = {}};
  if (!findings.others.empty()) table.heads.emplace_back("of all releases");
  const auto since = [&](double time) { return speech.time(time - findings.first_peak); };
  for (const Fall& fall : findings.falls) {
    table.rows.push_back({part_in_words(fall.part), speech.length(fall.amplitude), since(fall.time)});
    if (findings.others.empty()) continue;
    table.rows.back().push_back(fall.times ? range_html(since(fall.times->low), since(fall.times->high))
                                           : "not all get there");
  }
  return table_html(table);
}

std::string best_sentences(const Findings& findings) {
  const Speech speech(findings.subject.scales);
  const BestDamping& best = *findings.best;
  const double zeta = findings.subject.scene.damping_ratio;
  std::string text = "The loss factor η is the part of the energy lost per radian, read off " +
                     count_html(LossFactorOptions{}.half_cycles + 1) + " successive peaks. It is largest, " +
                     number_html(best.eta) + ", at an amplitude of " + speech.length(best.amplitude) +
                     ": the primary mass is damped there as by " + as_viscous(best.eta) + ". ";
  if (zeta > 0) text += "Its own damping accounts for η = 2ζ = " + number_html(2 * zeta) + " of that. ";
  if (best.etas && best.etas->low < best.etas->high)
    text += "Over all releases it is " +
            range_html(number_html(best.etas->low), number_html(best.etas->high)) + ", at " +
            range_html(speech.length(best.amplitudes->low), speech.length(best.amplitudes->high)) + ". ";
  if (best.amplitude == findings.loss.amplitude.back())
    text += "It is found at the end of the run: further down the damping may be better still. ";
  return text;
}

std::string theory_sentences(const Findings& findings) {
  const Speech speech(findings.subject.scales);
  const Scene& scene = findings.subject.scene;
  const double e = scene.restitution;
  if (e == 1)
    return "With <i>e</i> = 1 impacts lose no energy, they only hand it to the loose mass and back.";
  if (e == 0)
    return "With <i>e</i> = 0 there is no rebound, and the closed forms drawn for other restitutions do not "
           "hold.";
  const double eta = peak_loss(e) * scene.mass_ratio + 2 * scene.damping_ratio;
  constexpr double far_too_much = 0.5;  // for a decay in which the amplitude changes little from peak to peak
  std::string text =
      "For a light mass that strikes once in each half cycle there is a closed form: impacts damp best at an "
      "amplitude of " +
      speech.length(peak_loss_amplitude(e)) + ", (1 − <i>e</i>)/(1 + <i>e</i>)/π of the free travel";
  if (eta < far_too_much)
    text +=
        ", with η = " + number_html(eta) + " and a narrower peak than an average over half cycles can show";
  return text + ". To damp best at the amplitude that matters, choose a free travel of " +
         number_html(1 / peak_loss_amplitude(e)) + " times that amplitude.";
}

}  // namespace

std::string summary_html(const Findings& findings) {
  const Speech speech(findings.subject.scales);
  if (!findings.first_amplitude)
    return paragraph_html(
        "The primary mass never swings through its position of rest within this run, so there is no "
        "amplitude to speak of: only its motion and its energy are shown.");
  std::string text;
  if (!findings.forced())
    text = fall_in_short(findings);
  else if (findings.steady)
    text = "Under the exciting force the amplitude is in the end " + speech.length(findings.steady->mean) +
           " on average. ";
  if (findings.best)
    text += "It is damped best at an amplitude of " + speech.length(findings.best->amplitude) + ", as by " +
            as_viscous(findings.best->eta) + ". ";
  const double impacts = findings.energy_to_impacts(), lost = impacts + findings.run.energy->viscous_work;
  if (findings.run.impacts->time.empty())
    text += "There is no impact at all.";
  else if (lost > 0)
    text += "Impacts took " + percent_html(impacts / lost) + " of the energy that was lost.";
  return paragraph_html(text);
}

std::string decay_html(const Findings& findings) {
  const Speech speech(findings.subject.scales);
  if (!findings.first_amplitude)
    return paragraph_html("The run holds not one whole half cycle: there is no amplitude to follow.");
  if (findings.forced()) return paragraph_html(steady_sentences(findings));
  const double time = findings.last_peak - findings.first_peak;
  const double fallen = *findings.first_amplitude / findings.last_amplitude;
  std::string html =
      !findings.falls.empty()
          ? falls_table(findings)
          : paragraph_html(
                "Within this run the amplitude does not fall to half of its first value; it ends at " +
                speech.length(findings.last_amplitude) + ", " + percent_html(1 / fallen) + " of it.");
  if (time > 0 && std::isfinite(fallen) && fallen > 1)
    html += paragraph_html(
        "Over the whole run the amplitude fell as that of an oscillator with a viscous damping ratio of " +
        percent_html(logarithm(fallen) / time) + " would have" +
        (findings.best ? "; but impacts do not damp evenly, as the next section shows." : "."));
  return html;
}

std::string loss_html(const Findings& findings) {
  if (findings.forced())
    return paragraph_html(
        "A loss factor is read off a free decay. This motion is forced: see its amplitudes above, and its "
        "energy below.");
  if (!findings.first_amplitude)
    return paragraph_html("Without half cycles there is no loss factor to read off.");
  if (findings.best)
    return paragraph_html(best_sentences(findings)) + paragraph_html(theory_sentences(findings));
  const Scene& scene = findings.subject.scene;
  if (findings.run.impacts->time.empty())
    return paragraph_html("Without impacts the loss factor is that of viscous damping alone, η = 2ζ = " +
                          number_html(2 * scene.damping_ratio) + ", at every amplitude.");
  if (findings.loss.eta.empty())
    return paragraph_html(
        "The loss factor is averaged over " + count_html(LossFactorOptions{}.half_cycles) +
        " half cycles, and this run is too short for that: let it go further, by a later or a lower stop.");
  return paragraph_html(
      scene.restitution == 1
          ? "With <i>e</i> = 1 and without viscous damping nothing is ever lost: there is no loss factor."
          : "The amplitude does not fall: there is no loss factor to speak of.");
}

std::string energy_html(const Findings& findings) {
  const EnergyLedger& ledger = *findings.run.energy;
  const double brought = ledger.initial.total() + std::max(0.0, ledger.forcing_work);
  const double impacts = findings.energy_to_impacts();
  const auto& scales = findings.subject.scales;
  HtmlTable table{.caption = "The energy of both masses, from the beginning to the end of the run",
                  .heads = {"What"},
                  .rows = {}};
  if (scales) table.heads.emplace_back("J");
  table.heads.insert(table.heads.end(), {"by Kε²", "share"});
  const auto row = [&](const std::string& what, double energy) {
    table.rows.push_back({what});
    if (scales) table.rows.back().push_back(number_html(energy * scales->energy(), 4));
    table.rows.back().push_back(number_html(energy, 4));
    table.rows.back().push_back(brought > 0 ? percent_html(energy / brought) : "");
  };
  row("At the beginning", ledger.initial.total());
  if (findings.forced()) row("Brought by the exciting force", ledger.forcing_work);
  row("Taken by impacts", impacts);
  row("Taken by viscous damping", ledger.viscous_work);
  row("Left at the end", ledger.final.total());

  std::string text = "There are no impacts. ";
  if (const auto count = std::ssize(findings.run.impacts->time); count > 0) {
    text = count_html(count) + (count == 1 ? " impact was counted" : " impacts were counted");
    text += impacts > 0 && brought > 0
                ? ", which took " + percent_html(impacts / brought) + " of the energy. "
                : ". ";
  }
  return table_html(table) +
         paragraph_html(text + "What is left over when all are added up is " + number_html(ledger.residual) +
                        " of what went through: rounding.");
}

std::string prediction_html(const Findings& findings) {
  const Speech speech(findings.subject.scales);
  if (findings.others.empty())
    return paragraph_html(
        "Only one release was simulated (<code>--members 1</code>), so nothing can be said about how far "
        "small differences grow.");
  if (findings.spread.empty()) return paragraph_html("There is no amplitude whose spread could be told.");
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
          : "Up to an amplitude of " + speech.length(rows.amplitude[*findings.lost_row - 1]) + ", " +
                speech.time(rows.peak_time[*findings.lost_row - 1]) +
                " after the release, they agree within " + percent_html(lost_spread);
  return paragraph_html(
      text + agreement +
      "; then these differences have grown beyond that, as they do where the motion is chaotic, and no "
      "single run tells the amplitude at a given time any better. The greatest spread is " +
      percent_html(greatest) + ", the last " + percent_html(last) + ".");
}

}  // namespace impact_damper
