#include "print.hpp"

#include <algorithm>
#include <cstdio>
extern "C" int quadmath_snprintf(char*, std::size_t, const char*, ...);
namespace oracle {
std::string text(Quad number, int digits) {
  char out[96];
  quadmath_snprintf(out, sizeof out, "%.*Qg", digits, number);
  return out;
}
std::string lines_of(const Answer& answer) {
  struct Line {
    Quad time;
    std::string text;
  };
  std::vector<Line> lines;
  const bool several = answer.dampers.size() > 1;
  const auto name = [several](impact_damper::Wall wall, int damper) {
    return (wall == impact_damper::Wall::left ? "left" : "right") +
           (several ? ", damper " + std::to_string(damper) : "");
  };
  for (const Impact& each : answer.impacts)
    lines.push_back({each.time, "impact " + name(each.wall, each.damper) + " speed " +
                                    text(each.relative_velocity) + " at x " + text(each.displacement) +
                                    " loss " + text(each.loss, 12)});
  for (const Contact& each : answer.contacts) {
    lines.push_back({each.begin, "contact begins, " + name(each.wall, each.damper)});
    lines.push_back({each.end, "contact ends, " + name(each.wall, each.damper)});
  }
  for (std::size_t i = 0; i < answer.half_cycles.size(); ++i) {
    const HalfCycle& each = answer.half_cycles[i];
    lines.push_back({each.zero_crossing, "crossing, row " + std::to_string(i) + " amplitude " +
                                             text(each.amplitude) + " at " + text(each.peak_time)});
  }
  std::stable_sort(lines.begin(), lines.end(), [](const Line& a, const Line& b) { return a.time < b.time; });
  std::string all;
  for (const Line& line : lines) all += text(line.time) + "  " + line.text + "\n";
  const char* const stops[] = {"time", "amplitude", "effort"};
  all += text(answer.end_time) + "  end (" + stops[int(answer.stop)] + "), steps " +
         std::to_string(answer.steps) + "\n";
  all += "energy: initial " + text(answer.initial.total()) + " forcing " + text(answer.forcing_work) +
         " final " + text(answer.final.total()) + " viscous " + text(answer.viscous_work) + " impacts " +
         text(answer.losses()) + " residual " + text(answer.residual(), 3) + "\n";
  return all;
}
}  // namespace oracle
