#include "several_compare.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "impact_damper/simulate.hpp"
#include "list_of_one.hpp"
#include "print.hpp"

namespace several {
namespace {

using namespace impact_damper;
using oracle::magnitude, oracle::text;

constexpr double rounding = 0x1p-53;

std::vector<double> sample_times(double end) {  // as the engines' recorder places them
  std::vector<double> times;
  for (int i = 0; i < sample_count; ++i)
    times.push_back(i + 1 < sample_count ? double(i) / (sample_count - 1) * end : end);
  return times;
}

Answer answer_of(const Run& run) {
  Answer answer;
  answer.end_time = run.end_time;
  for (std::size_t i = 0; i < run.impacts->time.size(); ++i)
    answer.impacts.push_back({run.impacts->time[i], run.impacts->damper.at(i), run.impacts->wall[i],
                              run.impacts->relative_velocity[i], run.impacts->displacement[i],
                              run.energy->impact_loss[i]});
  for (std::size_t i = 0; i < run.contacts->begin.size(); ++i)
    answer.contacts.push_back(
        {run.contacts->begin[i], run.contacts->end[i], run.contacts->damper.at(i), run.contacts->wall[i]});
  for (std::size_t i = 0; i < run.half_cycles->amplitude.size(); ++i)
    answer.half_cycles.push_back(
        {run.half_cycles->zero_crossing[i], run.half_cycles->peak_time[i], run.half_cycles->amplitude[i]});
  for (std::size_t i = 0; i < run.history->time.size(); ++i) {
    Sample sample{run.history->x[i], run.history->v[i], {}, {}};
    for (const History::Damper& each : run.history->dampers)
      sample.y.push_back(each.y.at(i)), sample.w.push_back(each.w.at(i));
    answer.samples.push_back(sample);
  }
  const EnergyBalance& energy = *run.energy;
  const auto quad = [](const Energy& now) {
    return oracle::Energy{now.kinetic, now.spring, now.wall, now.paper};
  };
  answer.initial = quad(energy.initial), answer.final = quad(energy.final);
  answer.contact_loss = energy.contact_loss;
  for (const DamperEnergy& each : energy.dampers) {
    answer.damper_initial.push_back(each.initial_kinetic);
    answer.damper_final.push_back(each.final_kinetic);
    answer.damper_loss.push_back(Quad(each.impact_loss) + each.contact_loss + each.bounce_down_loss);
  }
  answer.viscous_work = energy.viscous_work, answer.forcing_work = energy.forcing_work;
  return answer;
}

// A number of both answers; `begin`: of sticking; `in_chattering`: an impact of a complete chattering.
enum class Kind { time, begin, state, energy };
struct Pair {
  std::string what;
  Quad at, mine, its;
  Kind kind = Kind::state;
  Quad size = 0;  // whatever is as large may be rounded in it; of a begin: times the tolerance
};

// Two answers side by side.
struct Walk {
  std::vector<Pair> pairs;
  std::int64_t impacts = 0, joint_impacts = 0, contacts = 0, joint_contacts = 0;
  std::optional<Quad> mismatch;
  std::string why;
  void fail(Quad t, const std::string& what) {
    if (!mismatch || t < *mismatch) mismatch = t, why = what;
  }
};

std::string said(const Impact& each) {
  return "damper " + std::to_string(each.damper) + (each.wall == Wall::left ? " left " : " right ") +
         text(each.time, 17) + " (" + text(each.relative_velocity, 6) + ")";
}
std::string said(const Contact& each) {
  return "damper " + std::to_string(each.damper) + (each.wall == Wall::left ? " left " : " right ") +
         text(each.begin, 17) + " to " + text(each.end, 17);
}
template <class T>
std::string said(const std::vector<T>& all, std::size_t i) {
  return i < all.size() ? said(all[i]) : "none";
}

// A damper's contacts; with rigid walls those that are apart by nothing are one, and those that last nothing
// are none. `nested`: others come shortly before, so that its begin depends on what is called nothing.
struct Sticking : Contact {
  bool nested = false;
};
std::vector<Sticking> contacts_of(const Answer& answer, int damper, const Tolerances& tolerances) {
  const double tolerance = tolerances.begin;
  std::vector<Sticking> contacts;
  if (tolerances.walls == Walls::compliant) {
    for (const Contact& each : answer.contacts)
      if (each.damper == damper) contacts.push_back({each});
    return contacts;
  }
  std::optional<Contact> last;
  for (const Contact& each : answer.contacts) {
    if (each.damper != damper) continue;
    const Quad nothing = Quad(tolerance) * (1 + each.begin);
    const bool same = last && last->wall == each.wall;
    if (same && !contacts.empty() && each.begin - contacts.back().end <= nothing) {
      contacts.back().end = each.end;
      contacts.back().nested = true;
    } else {
      contacts.push_back({each, same && each.begin - last->end <= 10 * nothing});
    }
    last = each;
  }
  std::erase_if(contacts, [&](const Sticking& each) {
    return each.end - each.begin <= Quad(tolerance) * (1 + each.begin);
  });
  return contacts;
}

void walk_impacts(Walk& walk, const Answer& a, const Answer& b, int damper, const Tolerances& tolerances) {
  const auto contacts = contacts_of(a, damper, tolerances);
  const auto of_damper = [&](const Answer& answer) {
    std::vector<Impact> impacts;
    for (const Impact& each : answer.impacts)
      if (each.damper == damper) impacts.push_back(each);
    return impacts;
  };
  const std::vector<Impact> mine = of_damper(a), its = of_damper(b);
  const auto omitted = [&](const Impact& each) {
    if (tolerances.walls == Walls::compliant) return false;
    if (!each.impulse) return true;
    // The end of a chattering that is cut short by another damper's.
    if (&each != mine.data() && &each != its.data() && magnitude(each.relative_velocity) <= Quad(1e-7L)) {
      const Impact& before = *(&each - 1);
      if (before.wall == each.wall && each.time - before.time <= Quad(tolerances.begin) * (1 + each.time))
        return true;
    }
    if (magnitude(each.relative_velocity) <= rounding) return true;
    return magnitude(each.relative_velocity) <= tolerances.chattering_speed &&
           std::any_of(contacts.begin(), contacts.end(), [&](const Contact& contact) {
             const Quad near = Quad(tolerances.begin) * (1 + each.time);
             return contact.wall == each.wall && each.time <= contact.end + near &&
                    contact.begin - each.time <= Quad(tolerances.chattering_time) * (1 + each.time);
           });
  };
  std::size_t i = 0, j = 0;
  const std::string name = "damper " + std::to_string(damper) + " impact ";
  while (i < mine.size() || j < its.size()) {
    const auto alike = [&](std::size_t m, std::size_t n) {
      if (m >= mine.size() || n >= its.size() || mine[m].wall != its[n].wall) return false;
      const Quad w = magnitude(mine[m].relative_velocity);
      // An impact of a chattering is told from the next one.
      return magnitude(mine[m].time - its[n].time) <= Quad(1e-6L) * (1 + mine[m].time) &&
             magnitude(mine[m].relative_velocity - its[n].relative_velocity) <=
                 std::max(w * Quad(1e-3L), Quad(1e-14L));
    };
    // In a chattering within another one alike impacts are near each other: the nearest is the one.
    const auto nearer = [&](const std::vector<Impact>& in, std::size_t n, const Impact& to) {
      return n + 1 < in.size() && omitted(in[n]) &&
             magnitude(in[n + 1].time - to.time) < magnitude(in[n].time - to.time);
    };
    if (i < mine.size() && j < its.size() && nearer(mine, i, its[j])) {
      ++i;
    } else if (i < mine.size() && j < its.size() && nearer(its, j, mine[i])) {
      ++j;
    } else if (alike(i, j)) {
      const Quad t = mine[i].time;
      const std::string which = name + std::to_string(i);
      ++walk.impacts;
      // What need not be listed may be rough, too: it changes nothing that comes later.
      const bool rough = omitted(mine[i]) && omitted(its[j]);
      walk.pairs.push_back(
          {which + " time", t, t, its[j].time, rough ? Kind::begin : Kind::time, rough ? Quad(1) : Quad(0)});
      if (!rough) {
        walk.pairs.push_back({which + " velocity", t, mine[i].relative_velocity, its[j].relative_velocity});
        walk.pairs.push_back({which + " x", t, mine[i].displacement, its[j].displacement});
        walk.pairs.push_back({which + " loss", t, mine[i].loss, its[j].loss, Kind::energy});
      }
      ++i, ++j;
    } else if (i < mine.size() && omitted(mine[i])) {
      ++i;
    } else if (j < its.size() && omitted(its[j])) {
      ++j;
    } else {
      const Quad t =
          i < mine.size() && (j >= its.size() || mine[i].time < its[j].time) ? mine[i].time : its[j].time;
      walk.fail(t, name + std::to_string(i) + ": " + said(its, j) + " where the oracle has " + said(mine, i));
      return;
    }
  }
}

void walk_contacts(Walk& walk, const Answer& a, const Answer& b, int damper, const Tolerances& tolerances) {
  const bool rigid = tolerances.walls == Walls::rigid;
  const auto mine = contacts_of(a, damper, tolerances), its = contacts_of(b, damper, tolerances);
  for (std::size_t n = 0; n < std::max(mine.size(), its.size()); ++n) {
    const std::string name = "damper " + std::to_string(damper) + " contact " + std::to_string(n);
    const std::string why = name + ": " + said(its, n) + " where the oracle has " + said(mine, n);
    if (n >= mine.size() || n >= its.size())
      return walk.fail(n < mine.size() ? mine[n].begin : its[n].begin, why);
    const auto near = [](Quad p, Quad q) { return magnitude(p - q) <= Quad(1e-5L) * (1 + p); };
    if (mine[n].wall != its[n].wall || !near(mine[n].begin, its[n].begin))
      return walk.fail(std::min(mine[n].begin, its[n].begin), why);
    const Quad uncertain = mine[n].nested || its[n].nested ? 30 : 3;
    walk.pairs.push_back({name + " begin", mine[n].begin, mine[n].begin, its[n].begin,
                          rigid ? Kind::begin : Kind::time, rigid ? uncertain : Quad(0)});
    if (!near(mine[n].end, its[n].end)) return walk.fail(std::min(mine[n].end, its[n].end), why);
    walk.pairs.push_back({name + " end", mine[n].end, mine[n].end, its[n].end, Kind::time});
    ++walk.contacts;
  }
}

void walk_rows(Walk& walk, const Answer& a, const Answer& b) {
  for (std::size_t n = 0; n < std::max(a.half_cycles.size(), b.half_cycles.size()); ++n) {
    const auto name = [&](const Answer& answer) {
      return n < answer.half_cycles.size() ? text(answer.half_cycles[n].zero_crossing, 17) : "none";
    };
    const std::string why =
        "crossing " + std::to_string(n) + ": " + name(b) + " where the oracle has " + name(a);
    if (n >= a.half_cycles.size() || n >= b.half_cycles.size())
      return walk.fail((n < a.half_cycles.size() ? a : b).half_cycles[n].zero_crossing, why);
    const HalfCycle &p = a.half_cycles[n], &q = b.half_cycles[n];
    const Quad t = p.zero_crossing;
    if (magnitude(t - q.zero_crossing) > Quad(1e-6L) * (1 + t))
      return walk.fail(std::min(t, q.zero_crossing), why);
    walk.pairs.push_back({"zero crossing " + std::to_string(n), t, t, q.zero_crossing, Kind::time});
    walk.pairs.push_back({"amplitude " + std::to_string(n), t, p.amplitude, q.amplitude});
    // Two peaks of one height may change places.
    if (magnitude(p.peak_time - q.peak_time) < Quad(1e-4L) * (1 + p.peak_time))
      walk.pairs.push_back({"peak time " + std::to_string(n), t, p.peak_time, q.peak_time, Kind::time});
  }
}

Walk walk(const Scene& scene, const Answer& a, const Answer& b, const Tolerances& tolerances) {
  Walk walk;
  const int count = int(scene.dampers.size());
  for (int damper = 0; damper < count; ++damper) {
    walk_impacts(walk, a, b, damper, tolerances);
    walk_contacts(walk, a, b, damper, tolerances);
  }
  for (std::size_t i = 0; i + 1 < a.impacts.size(); ++i)
    walk.joint_impacts += a.impacts[i].time == a.impacts[i + 1].time;
  for (std::size_t i = 0; i + 1 < a.contacts.size(); ++i)
    walk.joint_contacts +=
        a.contacts[i].begin < a.contacts[i + 1].end && a.contacts[i + 1].begin < a.contacts[i].end;
  walk_rows(walk, a, b);
  const std::vector<double> times = sample_times(*scene.until_time);
  for (std::size_t i = 0; i < std::min(a.samples.size(), b.samples.size()); ++i) {
    const Quad t = times[i];
    const Sample &p = a.samples[i], &q = b.samples[i];
    const std::string where = " at " + text(t, 17);
    walk.pairs.push_back({"x" + where, t, p.x, q.x});
    // An impact within rounding of a sample: before or after it?
    const auto coincides = [&](const Impact& each) {
      return magnitude(each.time - t) <= Quad(tolerances.begin) * (1 + t);
    };
    const bool rigid = tolerances.walls == Walls::rigid;
    const bool velocities = !rigid || std::none_of(a.impacts.begin(), a.impacts.end(), coincides);
    if (velocities) walk.pairs.push_back({"v" + where, t, p.v, q.v});
    for (int n = 0; n < count; ++n) {
      const std::string which = std::to_string(n) + where;
      // In a chattering y may already be zero where the other answer bounces on, and w, too.
      const auto chatters = [&](const Contact& each) {
        return each.damper == n && each.begin >= t &&
               each.begin - t <= Quad(tolerances.chattering_time) * (1 + t);
      };
      if (rigid && std::any_of(a.contacts.begin(), a.contacts.end(), chatters)) continue;
      walk.pairs.push_back({"y" + which, t, p.y.at(n), q.y.at(n), Kind::state, scene.dampers[n].clearance});
      if (velocities) walk.pairs.push_back({"w" + which, t, p.w.at(n), q.w.at(n)});
    }
  }
  // Energies add up whatever was there.
  Quad all = a.initial.total() + a.turnover;
  const auto energy = [&](const std::string& what, Quad mine, Quad its, bool first = false) {
    walk.pairs.push_back({what, first ? Quad(0) : a.end_time, mine, its, Kind::energy, all});
  };
  for (const bool first : {true, false}) {
    const oracle::Energy &p = first ? a.initial : a.final, &q = first ? b.initial : b.final;
    const std::string when = first ? "initial " : "final ";
    energy(when + "kinetic energy", p.kinetic, q.kinetic, first);
    energy(when + "spring energy", p.spring, q.spring, first);
    energy(when + "energy in walls", p.wall, q.wall, first);
    energy(when + "energy of the paper", p.paper, q.paper, first);
  }
  energy("loss in contacts without impact", a.contact_loss, b.contact_loss);
  energy("viscous work", a.viscous_work, b.viscous_work);
  energy("forcing work", a.forcing_work, b.forcing_work);
  for (int n = 0; n < count; ++n) {
    const std::string which = "damper " + std::to_string(n);
    energy(which + " initial energy", a.damper_initial.at(n), b.damper_initial.at(n), true);
    energy(which + " final energy", a.damper_final.at(n), b.damper_final.at(n));
    energy(which + " loss", a.damper_loss.at(n), b.damper_loss.at(n));
  }
  return walk;
}

// The largest difference so far, by time.
struct Growth {
  std::vector<std::pair<Quad, Quad>> entries;
  void take(const Walk& walk) {
    for (const Pair& each : walk.pairs) {
      if (each.kind == Kind::begin || (walk.mismatch && each.at >= *walk.mismatch)) continue;
      entries.push_back({each.at, magnitude(each.mine - each.its)});
    }
  }
  void sort() {
    std::sort(entries.begin(), entries.end());
    Quad most = 0;
    for (auto& each : entries) each.second = most = std::max(most, each.second);
  }
  Quad operator()(Quad t) const {
    const auto after = std::upper_bound(entries.begin(), entries.end(), t,
                                        [](Quad time, const auto& entry) { return time < entry.first; });
    return after == entries.begin() ? Quad(0) : std::prev(after)->second;
  }
};

struct Prediction {
  Answer answer;
  Growth growth;
  std::optional<Quad> ends;
  std::string why;
};

Prediction predict(const Scene& scene, const Tolerances& tolerances) {
  Question question;
  question.scene = scene;
  question.walls = tolerances.walls;
  if (question.walls == Walls::compliant) question.most_steps = tolerances.most_steps;
  question.samples = sample_times(*scene.until_time);
  Prediction result{answer_to(question), {}, {}, {}};
  const auto end_at = [&](Quad t, const std::string& why) {
    if (!result.ends || t < *result.ends) result.ends = t, result.why = why;
  };
  if (!result.answer.complete) {
    end_at(result.answer.end_time, "the oracle's effort");
    return result;
  }
  // Impacts on left and right walls that follow each other within rounding of their times: whether a mass
  // rests on its wall when the next one comes, or is a hair from it, is then no property of the scene in
  // double precision.
  const auto& impacts = result.answer.impacts;
  for (std::size_t i = 1; tolerances.walls == Walls::rigid && i < impacts.size(); ++i) {
    const Quad t = impacts[i].time;
    if (impacts[i].wall != impacts[i - 1].wall && t > impacts[i - 1].time &&
        t - impacts[i - 1].time <= Quad(4 * rounding) * (1 + t))
      end_at(impacts[i - 1].time, "rounding decides: left and right walls at one instant");
  }
  question.noise = 1e-16;
  for (question.seed = 1; question.seed <= 3; ++question.seed) {
    const Answer other = answer_to(question);
    if (!other.complete) end_at(other.end_time, "the oracle's effort");
    const Walk both = walk(scene, result.answer, other, tolerances);
    if (both.mismatch) end_at(*both.mismatch, "rounding decides: " + both.why);
    result.growth.take(both);
  }
  result.growth.sort();
  for (const auto& [t, difference] : result.growth.entries)
    if (difference > Quad(tolerances.predictable)) {
      end_at(t, "rounding has grown");
      break;
    }
  return result;
}

// What must hold in a run by itself.
void judge_order(const Run& run, const Answer& answer, Walls walls, std::vector<std::string>& differences) {
  const Impacts& impacts = *run.impacts;
  const std::size_t count = run.scene.dampers.size();
  const auto one_instant = [&](std::size_t i, std::size_t j) {
    const auto is = [&](const Impact& p, std::size_t n) {
      const Quad w = p.relative_velocity;
      return p.damper == impacts.damper[n] && magnitude(p.time - impacts.time[n]) <= Quad(1e-9L) &&
             magnitude(w - impacts.relative_velocity[n]) <= Quad(1e-3L) * magnitude(w);
    };
    for (std::size_t n = 0; n + 1 < answer.impacts.size(); ++n)
      for (std::size_t m = n + 1;
           m < answer.impacts.size() && answer.impacts[m].time == answer.impacts[n].time; ++m)
        if (is(answer.impacts[n], j) && is(answer.impacts[m], i)) return true;
    return false;
  };
  for (std::size_t i = 0; i + 1 < impacts.time.size(); ++i) {
    const double t = impacts.time[i], next = impacts.time[i + 1];
    if (t < next || (t == next && (impacts.damper[i] < impacts.damper[i + 1] || !one_instant(i, i + 1))))
      continue;
    differences.push_back("impacts " + std::to_string(i) + " and the next are not in order: damper " +
                          std::to_string(impacts.damper[i]) + " at " + text(t, 17));
  }
  // Impacts on rigid walls that the oracle has at one instant, and that are far from all others, have one
  // time.
  for (std::size_t i = 0; walls == Walls::rigid && i + 1 < answer.impacts.size(); ++i) {
    const Impact &p = answer.impacts[i], &q = answer.impacts[i + 1];
    if (p.time != q.time || p.wall != q.wall || magnitude(p.relative_velocity) < Quad(1e-4L)) continue;
    std::vector<double> times;
    for (std::size_t n = 0; n < impacts.time.size(); ++n)
      if ((impacts.damper[n] == p.damper || impacts.damper[n] == q.damper) &&
          magnitude(impacts.time[n] - p.time) <= Quad(1e-9L))
        times.push_back(impacts.time[n]);
    if (times.size() == 2 && times[0] != times[1])
      differences.push_back("impacts of one instant have two times: " + said(p) + " and " + said(q));
  }
  // Counts of the rows.
  const HalfCycles& rows = *run.half_cycles;
  if (rows.dampers.size() != count) {
    differences.push_back("half cycles have impacts of " + std::to_string(rows.dampers.size()) + " dampers");
    return;
  }
  std::vector<std::int64_t> before(count, 0);
  for (std::size_t row = 0; row < rows.zero_crossing.size(); ++row) {
    std::int64_t all = 0;
    for (std::size_t damper = 0; damper < count; ++damper) {
      all += rows.dampers[damper].impacts.at(row);
      before[damper] += rows.dampers[damper].impacts[row];
      std::int64_t sure = 0, possible = 0;
      for (std::size_t n = 0; n < impacts.time.size(); ++n) {
        if (impacts.damper[n] != std::int32_t(damper)) continue;
        const double near = 1e-9 * (1 + impacts.time[n]);
        sure += impacts.time[n] < rows.zero_crossing[row] - near;
        possible += impacts.time[n] <= rows.zero_crossing[row] + near;
      }
      if (before[damper] < sure || before[damper] > possible)
        differences.push_back("damper " + std::to_string(damper) + ": impacts up to row " +
                              std::to_string(row) + " are " + std::to_string(before[damper]) + ", true " +
                              std::to_string(sure));
    }
    if (all != rows.impacts[row])
      differences.push_back("impacts of row " + std::to_string(row) + " are not the sum of the dampers'");
  }
}

void judge(const Run& run, const Prediction& prediction, const Tolerances& tolerances, Comparison& result) {
  auto& differences = result.differences;
  if (run.stop_reason != StopReason::time || run.end_time != *run.scene.until_time)
    differences.push_back("stopped by " + std::string(name_of(run.stop_reason)) + " at " +
                          text(run.end_time, 17));
  const std::size_t count = run.scene.dampers.size();
  if (run.energy->dampers.size() != count || run.history->dampers.size() != count) {
    differences.push_back("energies or history of another number of dampers");
    return;
  }
  const Answer& answer = prediction.answer;
  const Walk both = walk(run.scene, answer, answer_of(run), tolerances);
  if (both.mismatch) differences.push_back(both.why);
  result.impacts = both.impacts, result.joint_impacts = both.joint_impacts;
  result.contacts = both.contacts, result.joint_contacts = both.joint_contacts;
  const Quad size = 1 + answer.initial.total() + answer.turnover;
  const auto speed_near = [&](Quad t) {
    Quad least = 1;
    for (const Impact& each : answer.impacts)
      if (magnitude(each.time - t) <= Quad(1e-9L) * (1 + t))
        least = std::min(least, std::max(magnitude(each.relative_velocity), Quad(1e-7L)));
    return least;
  };
  for (const Pair& each : both.pairs) {
    if (both.mismatch && each.at > *both.mismatch) continue;
    ++result.numbers;
    const Quad error = magnitude(each.mine - each.its);
    Quad unit = prediction.growth(each.at) + Quad(rounding) * (magnitude(each.mine) + each.size +
                                                               (each.kind == Kind::energy ? size : Quad(1)));
    // A slow impact is late by what distances are rounded, divided by its speed.
    if (each.kind != Kind::energy && each.kind != Kind::begin)
      unit += Quad(rounding / 100) * size / speed_near(each.at);
    double most = tolerances.growth;
    if (each.kind == Kind::begin) unit = each.size * Quad(tolerances.begin) * (1 + each.at), most = 1;
    const double ratio = double(error / unit);
    if (each.kind != Kind::begin) {
      if (!(ratio <= result.worst)) result.worst = ratio, result.worst_what = each.what;
      result.largest = std::max(result.largest, double(error / (1 + magnitude(each.mine) + each.size)));
    }
    if (!(ratio <= most))
      differences.push_back(each.what + " is " + text(each.its, 17) + ", true " + text(each.mine, 20) +
                            ", off by " + text(error, 3) + ", predicted " + text(unit, 3));
  }
  judge_order(run, answer, tolerances.walls, differences);
  if (!(std::fabs(run.energy->residual) <= 1e-12))
    differences.push_back("residual " + text(run.energy->residual, 3));
}

Record everything(double end) {
  Record record;
  record.impacts = record.contacts = record.energy = true;
  record.history = {{0, end, sample_count}};
  return record;
}

}  // namespace

Run simulated(const Scene& scene, Walls walls) {
  if (has_one_damper(scene)) {
    Run run = in_its_own_units(simulated(list_of_one(scene), walls));
    run.scene = scene;
    return run;
  }
  if (walls == Walls::compliant) return simulate(scene, Exact{}, everything(*scene.until_time));
  Restitution engine;
  engine.max_steps = 1'000'000;  // far more than any of these scenes needs
  return simulate(scene, engine, everything(*scene.until_time));
}

Comparison compare(const Scene& asked, const Tolerances& tolerances, const Program& program) {
  Comparison result;
  Scene scene = asked;
  result.asked = *scene.until_time;
  Prediction prediction = predict(scene, tolerances);
  for (int i = 0; i < 4 && prediction.ends; ++i) {
    result.ended_by = prediction.why;
    scene.until_time = double(*prediction.ends) * (1 - 1e-3) - 1e-6;
    if (!(*scene.until_time > 1e-3)) return result;
    prediction = predict(scene, tolerances);
  }
  if (prediction.ends) return result;
  result.until = *scene.until_time;
  try {
    judge(program ? program(scene) : simulated(scene, tolerances.walls), prediction, tolerances, result);
  } catch (const std::exception& error) {
    result.differences.push_back(std::string("throws: ") + error.what());
  }
  return result;
}

Run run_of_oracle(const Scene& scene, Fault fault, Walls walls) {
  Question question;
  question.scene = scene;
  question.fault = fault;
  question.walls = walls;
  question.samples = sample_times(*scene.until_time);
  Answer answer = answer_to(question);
  std::stable_sort(answer.impacts.begin(), answer.impacts.end(), [](const Impact& a, const Impact& b) {
    return std::pair(double(a.time), a.damper) < std::pair(double(b.time), b.damper);
  });
  const std::size_t count = scene.dampers.size();
  Run run;
  run.scene = scene;
  run.end_time = double(answer.end_time);
  run.impacts.emplace(), run.contacts.emplace(), run.half_cycles.emplace(), run.history.emplace();
  EnergyBalance& energy = run.energy.emplace();
  for (const Impact& each : answer.impacts) {
    run.impacts->time.push_back(double(each.time));
    run.impacts->wall.push_back(each.wall);
    run.impacts->damper.push_back(each.damper);
    run.impacts->relative_velocity.push_back(double(each.relative_velocity));
    run.impacts->displacement.push_back(double(each.displacement));
    energy.impact_loss.push_back(double(each.loss));
  }
  for (const Contact& each : answer.contacts) {
    run.contacts->begin.push_back(double(each.begin));
    run.contacts->end.push_back(double(each.end));
    run.contacts->damper.push_back(each.damper);
    run.contacts->wall.push_back(each.wall);
  }
  HalfCycles& rows = *run.half_cycles;
  rows.dampers.resize(count);
  Quad last = -1;
  for (const HalfCycle& each : answer.half_cycles) {
    rows.zero_crossing.push_back(double(each.zero_crossing));
    rows.peak_time.push_back(double(each.peak_time));
    rows.amplitude.push_back(double(each.amplitude));
    rows.impacts.push_back(0);
    for (HalfCycles::Damper& its : rows.dampers) its.impacts.push_back(0);
    for (const Impact& impact : answer.impacts)
      if (impact.time > last && impact.time <= each.zero_crossing)
        ++rows.impacts.back(), ++rows.dampers[impact.damper].impacts.back();
    last = each.zero_crossing;
  }
  // A fault may end the answer before the last of them.
  run.history->time.assign(question.samples.begin(),
                           question.samples.begin() + std::ptrdiff_t(answer.samples.size()));
  run.history->dampers.resize(count);
  for (const Sample& each : answer.samples) {
    run.history->x.push_back(double(each.x));
    run.history->v.push_back(double(each.v));
    for (std::size_t n = 0; n < count; ++n) {
      run.history->dampers[n].y.push_back(double(each.y[n]));
      run.history->dampers[n].w.push_back(double(each.w[n]));
    }
  }
  const auto rounded = [](const oracle::Energy& now) {
    return Energy{double(now.kinetic), double(now.spring), double(now.wall), double(now.paper)};
  };
  energy.initial = rounded(answer.initial), energy.final = rounded(answer.final);
  energy.contact_loss = double(answer.contact_loss);
  energy.viscous_work = double(answer.viscous_work), energy.forcing_work = double(answer.forcing_work);
  for (std::size_t n = 0; n < count; ++n)
    energy.dampers.push_back({double(answer.damper_initial[n]), double(answer.damper_final[n]),
                              double(answer.damper_loss[n]), 0, 0, 0});
  return run;
}

}  // namespace several
