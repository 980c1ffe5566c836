// The section of a report's page about a forced scene's amplitude over the frequency of the force.
#include <algorithm>
#include <array>
#include <cmath>

#include "application/report/page.hpp"
#include "application/report/quantities.hpp"
#include "impact_damper/analysis/design.hpp"

namespace impact_damper {
namespace {

// Returns "125 mm (12.5 ε)", or "without bound" for infinity.
std::string amplitude_or_none(const Quantities& quantities, double amplitude) {
  return std::isfinite(amplitude) ? quantities.length(amplitude) : "without bound";
}

bool is_given_up(const ArrivedMotion& motion) { return !motion.is_known(); }
bool is_open(const ArrivedMotion& motion) { return motion.is_known() && !motion.is_periodic(); }
bool is_changing(const ArrivedMotion& motion) { return motion.changes(); }

std::int64_t count_of(const ForcedResponse& response, bool (*counts)(const ArrivedMotion&)) {
  std::int64_t count = 0;
  for (const ResponsePoint& point : response.points) count += counts(point.rising) + counts(point.falling);
  return count;
}

// Returns a sentence on how impacts change the largest amplitude over all frequencies, which must be known.
std::string reduction_sentence(const Findings& findings) {
  const ArrivedMotion motion = findings.response.largest()->motion;
  const Scene& scene = findings.subject.scene;
  const double locked =
      worst_linear_response(scene.force_amplitude, 1 + secondary_mass(scene), scene.damping_ratio).amplitude;
  if (!std::isfinite(locked) || motion.changes()) return "";
  const double part = motion.amplitude() / locked;
  return "The impacts " +
         (part < 1 ? "take " + percent_html(1 - part) + " off" : "add " + percent_html(part - 1) + " to") +
         " the largest amplitude. " +
         (count_of(findings.response, is_given_up) > 0
              ? "Motions that were given up are not in this comparison. "
              : "");
}

// Returns "between 3.05 Hz and 3.09 Hz, at 3.2 Hz and in 2 more ranges up to 3.3 Hz".
std::string ranges_in_words(const Quantities& quantities, const ForcedResponse& response) {
  constexpr std::size_t most = 3;
  const std::vector<PointRange> ranges = response.two_motions();
  const auto frequency = [&](std::size_t i) { return quantities.frequency(response.points[i].frequency); };
  std::string text;
  const std::size_t told = std::min(ranges.size(), most);
  const std::size_t left = ranges.size() - told;
  for (std::size_t i = 0; i < told; ++i) {
    if (i > 0) text += i + 1 == told && left == 0 ? " and " : ", ";
    const auto& [first, last] = ranges[i];
    text +=
        first == last ? "at " + frequency(first) : "between " + frequency(first) + " and " + frequency(last);
  }
  if (left > 0)
    text += " and in " + count_html(std::int64_t(left)) + (left == 1 ? " more range" : " more ranges") +
            " up to " + frequency(ranges.back().last);
  return text;
}

// Returns the point at which the two ways differ most, if they do.
const ResponsePoint* most_different(const ForcedResponse& response) {
  const auto ratio = [](const ResponsePoint& point) {
    const double a = point.rising.amplitude(), b = point.falling.amplitude();
    return std::max(a, b) / std::min(a, b);
  };
  const ResponsePoint* most = nullptr;
  for (const ResponsePoint& point : response.points)
    if (point.has_two_motions() && !(most && ratio(point) <= ratio(*most))) most = &point;
  return most;
}

bool repeats(const ResponsePoint& point) { return point.rising.is_periodic() && point.falling.is_periodic(); }

std::string two_motions_sentences(const Findings& findings) {
  const Quantities quantities(findings.subject.scales);
  const ForcedResponse& response = findings.response;
  const ResponsePoint* const most = most_different(response);
  if (!most)
    return "Rising or falling, the frequency leads to the same amplitudes within " +
           percent_html(visible_difference) + ", where the motions are steady" +
           std::string(std::ranges::all_of(response.points, repeats)
                           ? ""
                           : ", and within the scatter of those that do not repeat") +
           ". A motion that neither way meets is still possible, from another release. ";
  const bool rises = most->rising.amplitude() > most->falling.amplitude();
  const std::array both{quantities.length(most->rising.amplitude()) + " if the frequency has risen to there",
                        quantities.length(most->falling.amplitude()) + " if it has fallen to there"};
  std::string text = "Two steady motions are possible " + ranges_in_words(quantities, response) +
                     ": which of them appears depends on how one arrives. At " +
                     quantities.frequency(most->frequency) + " the amplitude is " + both[rises ? 0 : 1] +
                     ", and " + both[rises ? 1 : 0] + ". ";
  if (std::ranges::any_of(response.points, [](const ResponsePoint& point) {
        return point.has_two_motions() && !repeats(point);
      }))
    text +=
        "Some of these motions do not repeat: they kept their amplitude when followed as long again, but may "
        "pass over to the other one later. ";
  return text;
}

// Returns the amplitude of a motion, with remarks.
std::string amplitude_cell(const Quantities& quantities, const ArrivedMotion& motion) {
  if (!motion.is_known()) return "given up";
  return quantities.length(motion.amplitude()) + (motion.changes() ? ", not steady yet" : "");
}

std::string method_sentences(const Findings& findings) {
  const Quantities quantities(findings.subject.scales);
  const ForcedResponse& response = findings.response;
  const std::int64_t open = count_of(response, is_open), changing = count_of(response, is_changing),
                     ended = count_of(response, is_given_up);
  const std::int64_t motions = 2 * std::ssize(response.points);
  std::string text = "With " + damper_of(findings) + " the frequency rises through " +
                     count_html(std::ssize(response.points)) + " values from " +
                     quantities.frequency(response.points.front().frequency) + " to " +
                     quantities.frequency(response.points.back().frequency) +
                     ", and falls again; at each the motion of the one before goes on until it repeats. ";
  if (open > 0)
    text += "Of " + count_html(motions) + " motions " + count_html(open) +
            (open == 1 ? " does not repeat" : " do not repeat") + " within " +
            count_html(response.rule.max_periods) +
            " periods of the force; the amplitude is then the largest in " +
            count_html(response.rule.mean_periods) + " further periods. ";
  if (changing > 0)
    text += count_html(changing) + " of these " + (changing == 1 ? "is" : "are") +
            " not steady yet, but still " + (changing == 1 ? "grows or decays" : "grow or decay") +
            ": the force feeds in clearly more or less power than impacts and damping take out, or the "
            "amplitude changed when the motion was followed for as long again. ";
  if (ended > 0)
    text += count_html(ended) + (ended == 1 ? " motion was" : " motions were") +
            " given up, because of too many impacts or steps in a period. ";
  return text + "Other frequencies, and longer, are for <code>impact-damper response sweep</code>. ";
}

std::string largest_sentence(const Findings& findings) {
  const Quantities quantities(findings.subject.scales);
  const ArrivedMotion motion = findings.response.largest()->motion;
  std::string text;
  if (motion.earlier_amplitude)
    text =
        "At its worst frequency the motion does not repeat. It was followed twice as long: its largest "
        "amplitude is first " +
        quantities.length(*motion.earlier_amplitude) + ", then " + quantities.length(motion.amplitude()) +
        ". ";
  if (motion.changes()) text += "The largest amplitude is not steady yet: do not rely on that number. ";
  return text;
}

}  // namespace

std::string damper_of(const Findings& findings) { return findings.several() ? "the dampers" : "the damper"; }
std::string masses_of(const Findings& findings) {
  return findings.several() ? "the secondary masses" : "the secondary mass";
}
std::string boxes_of(const Findings& findings) { return findings.several() ? "their boxes" : "its box"; }

std::string response_in_short(const Findings& findings) {
  const ForcedResponse& response = findings.response;
  const auto largest = response.largest();
  const Quantities quantities(findings.subject.scales);
  std::string given;
  if (findings.steady)
    given = "At the frequency given, " + quantities.frequency(findings.subject.scene.force_frequency) +
            ", the amplitude is at the end of the run " + quantities.length(findings.steady->greatest) +
            " at most, " + quantities.length(findings.steady->mean) + " on average";
  if (!largest) return given.empty() ? "" : given + ". ";
  const Scene& scene = findings.subject.scene;
  const double force = scene.force_amplitude, zeta = scene.damping_ratio, locked = 1 + secondary_mass(scene);
  const double amplitude = largest->motion.amplitude();
  const double worst_locked = worst_linear_response(force, locked, zeta).amplitude;
  const std::string masses = masses_of(findings);
  std::string text = "At its worst frequency, " + quantities.frequency(largest->frequency) +
                     ", the exciting force drives the damped mass to " + quantities.length(amplitude) +
                     (largest->motion.changes() ? ", which is not steady yet" : "") + "; with " + masses +
                     " locked to " + boxes_of(findings) + " the worst is " +
                     amplitude_or_none(quantities, worst_locked) + ". " + reduction_sentence(findings);
  if (!given.empty())
    text += given + "; with " + masses + " locked it would be " +
            amplitude_or_none(quantities, linear_response(force, locked, zeta, scene.force_frequency)) + ". ";
  if (!response.two_motions().empty())
    text += "Two steady motions are possible " + ranges_in_words(quantities, response) + ". ";
  return text;
}

std::string response_html(const Findings& findings) {
  const Quantities quantities(findings.subject.scales);
  const Scene& scene = findings.subject.scene;
  const ForcedResponse& response = findings.response;
  if (response.empty())
    return paragraph_html(
        "The run holds not one whole half cycle: it is too short to look at other frequencies.");
  const auto largest = response.largest();
  if (!largest)
    return paragraph_html(
        "Every motion was given up, because of too many impacts or steps in a period of the force.");
  const double force = scene.force_amplitude, zeta = scene.damping_ratio, given = scene.force_frequency;
  HtmlTable table{
      .caption = "Largest amplitude under the same force, at the worst frequency and at the one given",
      .heads = {"", "at its worst frequency", "that is at", "at " + quantities.frequency(given)}};
  const auto damped = [&](const std::string& what, ArrivedMotion ResponsePoint::*way) {
    const auto worst = response.largest(way);
    table.rows.push_back({what, worst ? amplitude_cell(quantities, worst->motion) : "given up",
                          worst ? quantities.frequency(worst->frequency) : "",
                          amplitude_cell(quantities, response.points[response.given].*way)});
  };
  damped("with " + damper_of(findings) + ", the frequency rising", &ResponsePoint::rising);
  damped("with " + damper_of(findings) + ", the frequency falling", &ResponsePoint::falling);
  if (findings.steady)
    table.rows.push_back({"with " + damper_of(findings) + ", at the end of this run", "", "",
                          quantities.length(findings.steady->greatest)});
  const auto linear = [&](const std::string& what, double mass) {
    const WorstResponse most = worst_linear_response(force, mass, zeta);
    table.rows.push_back({what, amplitude_or_none(quantities, most.amplitude),
                          quantities.frequency(most.frequency),
                          amplitude_or_none(quantities, linear_response(force, mass, zeta, given))});
  };
  linear(masses_of(findings) + " locked to " + boxes_of(findings), 1 + secondary_mass(scene));
  linear(findings.several() ? "the boxes empty" : "the box empty", 1);
  const std::string text =
      std::string(findings.several()
                      ? "The secondary masses also weigh on the primary one and shift its resonance. "
                      : "The secondary mass also weighs on the primary one and shifts its resonance. ") +
      "What the impacts do is the difference to " + masses_of(findings) + " locked to " + boxes_of(findings) +
      ", over all frequencies; at a single frequency most of it may be the shift. " +
      reduction_sentence(findings);
  return paragraph_html(text) + table_html(table) + paragraph_html(two_motions_sentences(findings)) +
         paragraph_html(method_sentences(findings) + largest_sentence(findings));
}

}  // namespace impact_damper
