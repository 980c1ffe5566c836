#include "impact_damper/report/page_parts.hpp"

#include <algorithm>
#include <cmath>

#include "impact_damper/analysis/theory.hpp"
#include "impact_damper/motion/elementary.hpp"
#include "impact_damper/report/speech.hpp"

namespace impact_damper {
namespace {

std::string paragraph(const std::string& text) { return "<p>" + text + "</p>\n"; }

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

// An equivalent viscous damping ratio: that of an oscillator with this loss factor.
std::string as_viscous(double eta) { return "a viscous damping ratio of " + percent_html(eta / 2); }

}  // namespace

std::string summary_html(const Findings& findings) {
  const Speech speech(findings.subject.scales);
  if (!findings.first_amplitude)
    return paragraph(
        "The primary mass never swings through its position of rest within this run, so there is no "
        "amplitude to "
        "speak of: only its motion and its energy are shown.");
  std::string text;
  if (findings.forced()) {
    if (findings.steady)
      text = "Under the exciting force the amplitude is in the end " + speech.length(findings.steady->mean) +
             " on average. ";
  } else {
    text = "From an amplitude of " + speech.length(*findings.first_amplitude) + " ";
    const Fall* tenth = findings.falls.size() > 1 ? &findings.falls[1] : nullptr;
    text +=
        tenth ? "the motion falls to a tenth within " + speech.time(tenth->time - findings.first_peak) + ". "
              : "the motion falls to " + speech.length(findings.last_amplitude) + " by the end of the run. ";
    if (findings.best)
      text += "It is damped best at an amplitude of " + speech.length(findings.best->amplitude) + ", as by " +
              as_viscous(findings.best->eta) + ". ";
  }
  const double lost = findings.energy_to_impacts() + findings.run.energy->viscous_work;
  if (findings.run.impacts->time.empty())
    text += "There is no impact at all. ";
  else if (lost > 0)
    text += "Impacts took " + percent_html(findings.energy_to_impacts() / lost) +
            " of the energy that was lost. ";
  return paragraph(text);
}

std::string decay_html(const Findings& findings) {
  const Speech speech(findings.subject.scales);
  if (!findings.first_amplitude)
    return paragraph("The run holds not one whole half cycle: there is no amplitude to follow.");
  if (findings.forced()) {
    if (!findings.steady)
      return paragraph("The run is too short to speak of a steady motion: it has " +
                       count_html(std::ssize(findings.run.half_cycles->amplitude)) + " half cycles.");
    const SteadyState& steady = *findings.steady;
    std::string text = "In the last quarter of the run the amplitude lies between " +
                       speech.length(steady.least) + " and " + speech.length(steady.greatest) + ", " +
                       speech.length(steady.mean) + " on average. ";
    if (steady.without_impacts)
      text += "With the loose mass taken out the same force would hold the primary mass at " +
              speech.length(*steady.without_impacts) + ".";
    else
      text +=
          "With the loose mass taken out the amplitude would grow without end: the force meets the undamped "
          "primary mass "
          "at its natural frequency.";
    return paragraph(text);
  }

  std::string html;
  if (findings.falls.empty()) {
    html = paragraph("Within this run the amplitude does not fall to half of its first value; it ends at " +
                     speech.length(findings.last_amplitude) + ", " +
                     percent_html(findings.last_amplitude / *findings.first_amplitude) + " of it.");
  } else {
    HtmlTable table{
        .caption = "When the amplitude first was below a part of the first one, counted from the first peak",
        .heads = {"Below", "that is", "within"},
        .rows = {}};
    if (!findings.others.empty()) table.heads.push_back("of all releases");
    for (const Fall& fall : findings.falls) {
      const auto since = [&](double time) { return time - findings.first_peak; };
      table.rows.push_back(
          {part_in_words(fall.part), speech.length(fall.amplitude), speech.time(since(fall.time))});
      if (findings.others.empty()) continue;
      if (!fall.times) {
        table.rows.back().push_back("not all get there");
        continue;
      }
      const std::string low = speech.time(since(fall.times->low)),
                        high = speech.time(since(fall.times->high));
      table.rows.back().push_back(shown(low) == shown(high) ? high : low + " to " + high);
    }
    html = table_html(table);
  }
  const double time = findings.last_peak - findings.first_peak;
  const double fallen = *findings.first_amplitude / findings.last_amplitude;
  if (time > 0 && std::isfinite(fallen) && fallen > 1) {
    html += paragraph(
        "Over the whole run the amplitude fell as that of an oscillator with a viscous damping ratio of " +
        percent_html(logarithm(fallen) / time) +
        " would have; but impacts do not damp evenly, as the next "
        "section shows.");
  }
  return html;
}

std::string loss_html(const Findings& findings) {
  const Speech speech(findings.subject.scales);
  const Scene& scene = findings.subject.scene;
  if (findings.forced())
    return paragraph(
        "A loss factor is read off a free decay. This motion is forced: see its amplitudes above, and its "
        "energy "
        "below.");
  if (!findings.best)
    return paragraph(findings.loss.eta.empty()
                         ? "The loss factor is averaged over ten half cycles, and this run is too short for "
                           "that: let it go "
                           "further, by a later or a lower stop."
                         : "The amplitude does not fall: there is no loss factor to speak of.");
  const BestDamping& best = *findings.best;
  std::string html = paragraph(
      "The loss factor η is the part of the energy lost per radian, read off eleven successive peaks. It is "
      "largest, " +
      number_html(best.eta) + ", at an amplitude of " + speech.length(best.amplitude) +
      ": the primary mass is damped there as by " + as_viscous(best.eta) + ". " +
      (scene.damping_ratio > 0
           ? "Its own damping accounts for η = 2ζ = " + number_html(2 * scene.damping_ratio) + " of that. "
           : "") +
      (best.etas && best.etas->low < best.etas->high
           ? "Over all releases the largest lies between " + number_html(best.etas->low) + " and " +
                 number_html(best.etas->high) + ". "
           : ""));
  if (best.amplitude == findings.loss.amplitude.back())
    html += paragraph("That is the last amplitude of the run: further down the damping may be better still.");
  const double e = scene.restitution;
  if (e > 0 && e < 1) {
    html += paragraph(
        "For a light mass that strikes once in each half cycle there is a closed form: impacts damp best at "
        "an amplitude of " +
        speech.length(peak_loss_amplitude(e)) +
        ", (1 − <i>e</i>)/(1 + <i>e</i>)/π of the free travel, with η = " +
        number_html(peak_loss(e) * scene.mass_ratio + 2 * scene.damping_ratio) +
        " and a narrower peak than the average over ten half cycles can show. To damp best at the amplitude "
        "that matters, "
        "choose the free travel " +
        number_html(1 / peak_loss_amplitude(e)) + " times as long.");
  } else {
    html += paragraph(
        e == 1
            ? "With <i>e</i> = 1 impacts lose no energy; whatever the curve shows of them is energy "
              "handed to the loose mass and back."
            : "With <i>e</i> = 0 there is no rebound, and the closed forms drawn for other restitutions do "
              "not hold.");
  }
  return html;
}

std::string energy_html(const Findings& findings) {
  const EnergyLedger& ledger = *findings.run.energy;
  const double brought = ledger.initial.total() + std::max(0.0, ledger.forcing_work);
  HtmlTable table{.caption = "The energy of both masses, from the beginning to the end of the run",
                  .heads = {"What"},
                  .rows = {}};
  const auto& scales = findings.subject.scales;
  if (scales) table.heads.push_back("J");
  table.heads.insert(table.heads.end(), {"by Kε²", "share"});
  const auto row = [&](const std::string& what, double energy) {
    table.rows.push_back({what});
    if (scales) table.rows.back().push_back(number_html(energy * scales->energy(), 4));
    table.rows.back().push_back(number_html(energy, 4));
    table.rows.back().push_back(brought > 0 ? percent_html(energy / brought) : "");
  };
  row("At the beginning", ledger.initial.total());
  if (findings.forced()) row("Brought by the exciting force", ledger.forcing_work);
  row("Taken by impacts", findings.energy_to_impacts());
  row("Taken by viscous damping", ledger.viscous_work);
  row("Left at the end", ledger.final.total());
  std::string html = table_html(table);
  const std::string balance = "What is left over when all are added up is " + number_html(ledger.residual) +
                              " of what went through: rounding.";
  if (findings.run.impacts->time.empty()) return html + paragraph("There are no impacts. " + balance);
  const double impacts = findings.energy_to_impacts();
  return html + paragraph(count_html(std::ssize(findings.run.impacts->time)) + " impacts were counted" +
                          (impacts > 0 && brought > 0
                               ? ", which took " + percent_html(impacts / brought) + " of " +
                                     (findings.forced() ? "the energy brought in" : "the first energy") + ". "
                               : ". ") +
                          balance);
}

std::string prediction_html(const Findings& findings) {
  const Speech speech(findings.subject.scales);
  if (findings.others.empty())
    return paragraph(
        "Only one release was simulated (<code>--members 1</code>), so nothing can be said about how far "
        "small "
        "differences grow.");
  const std::int64_t members = std::ssize(findings.others) + 1;
  if (findings.spread.empty()) return paragraph("There is no amplitude whose spread could be told.");
  std::string text =
      count_html(members) + " releases that differ by no more than a millionth were followed. ";
  const double greatest = std::ranges::max(findings.spread), last = findings.spread.back();
  if (findings.lost_row) {
    const HalfCycles& rows = *findings.run.half_cycles;
    text += "Up to an amplitude of " + speech.length(rows.amplitude[*findings.lost_row]) + ", " +
            speech.time(rows.peak_time[*findings.lost_row]) + " after the release, they agree within " +
            percent_html(lost_spread) +
            "; then chaos has made the millionth as large as that, and no single run tells the "
            "amplitude at a given time any better. The greatest spread is " +
            percent_html(greatest) + ", the last " + percent_html(last) + ".";
  } else {
    text += "They never part by more than " + percent_html(greatest) +
            " in amplitude: within this run the motion can be "
            "predicted.";
  }
  return paragraph(text);
}

}  // namespace impact_damper
