#include "compare.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>

#include "impact_damper/simulate.hpp"
#include "print.hpp"

namespace oracle {
namespace {

using namespace impact_damper;
using impact_damper::Energy;

constexpr double rounding = 0x1p-53;
constexpr int samples_of_a_run = 65;

// As the engines' recorder places them.
std::vector<double> sample_times(double end) {
  std::vector<double> times;
  for (int i = 0; i < samples_of_a_run; ++i)
    times.push_back(i + 1 < samples_of_a_run ? double(i) / (samples_of_a_run - 1) * end : end);
  return times;
}

// What has a growth of its own.
enum Kind { time_, peak_time_, x_, v_, y_, w_, loss_, kinds_ };

// The events of an answer or of a run, in one form.
struct Events {
  std::vector<oracle::Impact> impacts;
  std::vector<Contact> contacts;
  std::vector<HalfCycle> rows;
  std::vector<bool> merged;  // rows that were three
};

Events events_of(const Answer& answer) { return {answer.impacts, answer.contacts, answer.half_cycles, {}}; }
Events events_of(const Run& run) {
  Events events;
  for (std::size_t i = 0; i < run.impacts->time.size(); ++i)
    events.impacts.push_back({run.impacts->time[i],
                              run.impacts->wall[i],
                              run.impacts->relative_velocity[i],
                              run.energy->impact_loss[i],
                              {}});
  for (std::size_t i = 0; i < run.contacts->begin.size(); ++i)
    events.contacts.push_back({run.contacts->begin[i], run.contacts->end[i], run.contacts->wall[i]});
  for (std::size_t i = 0; i < run.half_cycles->amplitude.size(); ++i)
    events.rows.push_back(
        {run.half_cycles->zero_crossing[i], run.half_cycles->peak_time[i], run.half_cycles->amplitude[i]});
  return events;
}

// Below these nothing can be said of an event: it is there or not by rounding.
struct Negligible {
  std::function<Quad(Quad)> duration, speed, length;
};

// Where events coincide, rounding decides whether a contact of no length is recorded, whether one is cut in
// two by a touch, and whether a touch of x = 0 is two crossings or none: all such are taken out.
void simplify(Events& events, const Negligible& below) {
  std::vector<Contact> contacts;
  for (const Contact& each : events.contacts) {
    if (!contacts.empty() && contacts.back().wall == each.wall &&
        each.begin - contacts.back().end <= below.duration(each.begin)) {
      contacts.back().end = each.end;
      continue;
    }
    contacts.push_back(each);
  }
  std::erase_if(contacts,
                [&](const Contact& each) { return each.end - each.begin <= below.duration(each.begin); });
  events.contacts = contacts;
  std::vector<HalfCycle> rows;
  std::vector<bool> merged;
  for (std::size_t i = 0; i < events.rows.size(); ++i) {
    const HalfCycle& each = events.rows[i];
    // Not the first row: how small it is is exactly known.
    if (i > 0 && i + 1 < events.rows.size() && each.amplitude <= below.length(each.zero_crossing)) {
      const HalfCycle& next = events.rows[++i];
      HalfCycle& last = rows.back();
      last.zero_crossing = next.zero_crossing;
      if (next.amplitude > last.amplitude) last.amplitude = next.amplitude, last.peak_time = next.peak_time;
      merged.back() = true;
      continue;
    }
    rows.push_back(each);
    merged.push_back(false);
  }
  events.rows = rows;
  events.merged = merged;
}

// The two lists side by side.
struct Walk {
  std::vector<std::array<std::size_t, 2>> impacts;  // of the first, of the second list
  std::vector<std::size_t> skipped;                 // of the first list: jumped over by the second
  std::int64_t jumps = 0;
  std::optional<Quad> mismatch;  // the first time at which they are not the same
  std::string what;
  void fail(Quad t, const std::string& why) {
    if (!mismatch || t < *mismatch) mismatch = t, what = why;
  }
};

std::string said(const oracle::Impact& impact) {
  return std::string(impact.wall == Wall::left ? "left " : "right ") + text(impact.time, 17) + " (" +
         text(impact.relative_velocity, 6) + ")";
}

Walk walk(const Events& a, const Events& b, const Negligible& below) {
  Walk both;
  std::size_t i = 0, j = 0;
  const auto slow = [&](const oracle::Impact& each) {
    return magnitude(each.relative_velocity) <= below.speed(each.time);
  };
  const auto window = [&](Quad t) { return std::max(Quad(1e-7L) * (1 + t), below.duration(t)); };
  while (i < a.impacts.size() || j < b.impacts.size()) {
    const bool have_a = i < a.impacts.size(), have_b = j < b.impacts.size();
    // The same impact: the nearest in time that is left. How near is judged by the numbers' comparison.
    if (have_a && have_b && a.impacts[i].wall == b.impacts[j].wall) {
      const auto &p = a.impacts[i], &q = b.impacts[j];
      const Quad apart = magnitude(p.time - q.time);
      // In a chattering impacts are near each other: theirs must be nearer than the next one.
      const bool next_is_nearer = i + 1 < a.impacts.size() &&
                                  magnitude(a.impacts[i + 1].time - q.time) < apart &&
                                  a.impacts[i + 1].wall == q.wall;
      const bool alike = magnitude(p.relative_velocity - q.relative_velocity) <=
                         magnitude(p.relative_velocity) / 2 + below.speed(p.time);
      if (apart <= window(p.time) && !next_is_nearer && alike) {
        both.impacts.push_back({i++, j++});
        continue;
      }
    }
    if (have_a && slow(a.impacts[i])) {
      ++i;
      continue;
    }
    if (have_b && slow(b.impacts[j])) {
      ++j;
      continue;
    }
    // The rest of a complete chattering, that the other list jumps over.
    if (have_a && a.impacts[i].accumulation) {
      const Quad end = *a.impacts[i].accumulation;
      if (!have_b || b.impacts[j].time > end - below.duration(end)) {
        while (i < a.impacts.size() && a.impacts[i].accumulation && *a.impacts[i].accumulation == end)
          both.skipped.push_back(i++);
        ++both.jumps;
        continue;
      }
    }
    if (have_b && b.impacts[j].accumulation) {
      const Quad end = *b.impacts[j].accumulation;
      if (!have_a || a.impacts[i].time > end - below.duration(end)) {
        while (j < b.impacts.size() && b.impacts[j].accumulation && *b.impacts[j].accumulation == end) ++j;
        continue;
      }
    }
    const Quad t =
        !have_b || (have_a && a.impacts[i].time < b.impacts[j].time) ? a.impacts[i].time : b.impacts[j].time;
    both.fail(t, "impact " + std::to_string(i) + ": " + (have_b ? said(b.impacts[j]) : "none") +
                     " where the oracle has " + (have_a ? said(a.impacts[i]) : "none"));
    break;
  }
  for (std::size_t n = 0; n < std::max(a.contacts.size(), b.contacts.size()); ++n) {
    const auto name = [&](const Events& e) {
      return n < e.contacts.size() ? std::string(e.contacts[n].wall == Wall::left ? "left " : "right ") +
                                         text(e.contacts[n].begin, 17) + " to " + text(e.contacts[n].end, 17)
                                   : "none";
    };
    const bool have = n < a.contacts.size() && n < b.contacts.size();
    const Quad t = n < a.contacts.size()
                       ? (n < b.contacts.size() ? std::min(a.contacts[n].begin, b.contacts[n].begin)
                                                : a.contacts[n].begin)
                       : b.contacts[n].begin;
    if (!have || a.contacts[n].wall != b.contacts[n].wall ||
        magnitude(a.contacts[n].begin - b.contacts[n].begin) > window(t)) {
      both.fail(t, "contact " + std::to_string(n) + ": " + name(b) + " where the oracle has " + name(a));
      break;
    }
    const Quad end = std::min(a.contacts[n].end, b.contacts[n].end);
    if (magnitude(a.contacts[n].end - b.contacts[n].end) > window(end)) {
      both.fail(end, "contact " + std::to_string(n) + ": " + name(b) + " where the oracle has " + name(a));
      break;
    }
  }
  for (std::size_t n = 0; n < std::max(a.rows.size(), b.rows.size()); ++n) {
    const auto name = [&](const Events& e) {
      return n < e.rows.size() ? text(e.rows[n].zero_crossing, 17) : "none";
    };
    const bool have = n < a.rows.size() && n < b.rows.size();
    const Quad t = n < a.rows.size()
                       ? (n < b.rows.size() ? std::min(a.rows[n].zero_crossing, b.rows[n].zero_crossing)
                                            : a.rows[n].zero_crossing)
                       : b.rows[n].zero_crossing;
    if (!have || magnitude(a.rows[n].zero_crossing - b.rows[n].zero_crossing) > window(t)) {
      both.fail(t, "crossing " + std::to_string(n) + ": " + name(b) + " where the oracle has " + name(a));
      break;
    }
  }
  return both;
}

// The largest error that rounding made so far, for each kind; for a rounding of 2^-53.
class Growth {
 public:
  void take(Kind kind, Quad time, Quad difference) {
    entries_[kind].push_back({time, magnitude(difference)});
  }
  void settle() {
    for (auto& each : entries_) {
      std::sort(each.begin(), each.end(), [](const Entry& a, const Entry& b) { return a.time < b.time; });
      Quad most = 0;
      for (Entry& entry : each) entry.difference = most = std::max(most, entry.difference);
    }
  }
  // Up to this time and a little later: an event itself lies between samples.
  Quad operator()(Kind kind, Quad time) const {
    const auto& each = entries_[kind];
    auto after = std::upper_bound(each.begin(), each.end(), time + slack,
                                  [](Quad t, const Entry& entry) { return t < entry.time; });
    return after == each.begin() ? Quad(0) : std::prev(after)->difference;
  }
  Quad slack = 0;
  const auto& entries(Kind kind) const { return entries_[kind]; }
  struct Entry {
    Quad time, difference;
  };

 private:
  std::array<std::vector<Entry>, kinds_> entries_;
};

struct Noise {
  double size;
  std::uint64_t seed;
};
constexpr std::array<Noise, 3> noises{{{1e-24, 1}, {1e-24, 2}, {4 * rounding, 3}}};

// What the scene's own numbers are as large as, up to then.
struct Sizes {
  std::vector<Quad> times;
  std::array<std::vector<Quad>, kinds_> most;
};

struct Prediction {
  Answer answer;  // without noise
  Growth growth;
  Sizes sizes;
  std::optional<Quad> ends;  // when nothing can be predicted beyond
  std::string why;
  std::vector<std::array<Quad, 4>> samples;  // growth at each sample
  std::array<Quad, 10> totals{};             // growth of the ledger's numbers at the end
};

std::array<Quad, 10> totals_of(const Answer& answer) {
  Quad losses = 0;
  for (const oracle::Impact& each : answer.impacts) losses += each.loss;
  return {
      answer.final.kinetic, answer.final.spring, answer.final.wall,   answer.final.paper,  losses,
      answer.contact_loss,  answer.chatter_loss, answer.viscous_work, answer.forcing_work, answer.end_time};
}

Prediction predict(Question question) {
  Prediction result;
  const double end = *question.scene.until_time;
  question.samples = sample_times(end);
  result.answer = answer_to(question);
  const Answer& plain = result.answer;
  result.growth.slack = end / samples_of_a_run;
  const auto end_at = [&](Quad t, const std::string& why) {
    if (!result.ends || t < *result.ends) result.ends = t, result.why = why;
  };
  if (plain.stop == Stop::effort) end_at(plain.end_time, "the oracle's effort");
  result.samples.resize(question.samples.size());

  // Sizes so far, of each kind.
  Quad x = magnitude(question.scene.x0), v = magnitude(question.scene.v0), y = magnitude(question.scene.y0),
       w = magnitude(question.scene.w0);
  for (std::size_t i = 0; i < plain.samples.size(); ++i) {
    const Sample& each = plain.samples[i];
    x = std::max(x, magnitude(each.x)), v = std::max(v, magnitude(each.v));
    y = std::max(y, magnitude(each.y)), w = std::max(w, magnitude(each.w));
    const Quad t = question.samples[i];
    result.sizes.times.push_back(t);
    const std::array<Quad, kinds_> now{t, t, x, v, y, w, v * v + x * x};
    for (int k = 0; k < kinds_; ++k) result.sizes.most[k].push_back(now[k]);
  }

  for (const Noise& noise : noises) {
    question.noise = noise.size;
    question.seed = noise.seed;
    const Answer other = answer_to(question);
    const Quad per_rounding = Quad(rounding) / noise.size;
    const std::size_t samples = std::min(plain.samples.size(), other.samples.size());
    if (other.stop == Stop::effort) end_at(other.end_time, "the oracle's effort");
    for (std::size_t i = 0; i < samples; ++i) {
      const Quad t = question.samples[i];
      const Sample &a = plain.samples[i], &b = other.samples[i];
      const std::array<Quad, 4> off{magnitude(a.x - b.x) * per_rounding, magnitude(a.v - b.v) * per_rounding,
                                    magnitude(a.y - b.y) * per_rounding, magnitude(a.w - b.w) * per_rounding};
      for (int k = 0; k < 4; ++k) result.samples[i][k] = std::max(result.samples[i][k], off[k]);
      // A contact's velocities change fast: off by as much as the time of its begin, they are so only there.
      if (a.in_contact || b.in_contact) continue;
      result.growth.take(x_, t, off[0]);
      result.growth.take(v_, t, off[1]);
      result.growth.take(y_, t, off[2]);
      result.growth.take(w_, t, off[3]);
    }
    // Events: what is negligible is so by this noise alone.
    const auto grown = [&](Kind kind) {
      return [&, kind](Quad t) {
        Quad most = 0;
        for (std::size_t i = 0; i < samples; ++i) {
          const Sample &a = plain.samples[i], &b = other.samples[i];
          most = std::max(most, kind == w_ ? magnitude(a.w - b.w) + magnitude(a.v - b.v)
                                           : magnitude(a.x - b.x) + magnitude(a.y - b.y));
          if (Quad(question.samples[i]) > t) break;
        }
        return 1000 * (most + Quad(noise.size) * (t + 1));
      };
    };
    const Negligible below{grown(x_), grown(w_), grown(x_)};
    Events a = events_of(plain), b = events_of(other);
    simplify(a, below), simplify(b, below);
    const Walk both = walk(a, b, below);
    if (both.mismatch) end_at(*both.mismatch, "rounding decides: " + both.what);
    for (const auto& [i, j] : both.impacts) {
      const auto &p = a.impacts[i], &q = b.impacts[j];
      if (both.mismatch && p.time >= *both.mismatch) break;
      result.growth.take(time_, p.time, (p.time - q.time) * per_rounding);
      result.growth.take(w_, p.time, (p.relative_velocity - q.relative_velocity) * per_rounding);
      result.growth.take(loss_, p.time, (p.loss - q.loss) * per_rounding);
    }
    for (std::size_t i = 0; i < std::min(a.contacts.size(), b.contacts.size()); ++i) {
      const auto &p = a.contacts[i], &q = b.contacts[i];
      if (both.mismatch && p.end >= *both.mismatch) break;
      result.growth.take(time_, p.begin, (p.begin - q.begin) * per_rounding);
      result.growth.take(time_, p.end, (p.end - q.end) * per_rounding);
    }
    for (std::size_t i = 0; i < std::min(a.rows.size(), b.rows.size()); ++i) {
      const auto &p = a.rows[i], &q = b.rows[i];
      if (both.mismatch && p.zero_crossing >= *both.mismatch) break;
      result.growth.take(time_, p.zero_crossing, (p.zero_crossing - q.zero_crossing) * per_rounding);
      result.growth.take(x_, p.zero_crossing, (p.amplitude - q.amplitude) * per_rounding);
      // Two peaks of one height may change places.
      if (magnitude(p.peak_time - q.peak_time) < Quad(1e-4L) * (1 + p.peak_time))
        result.growth.take(peak_time_, p.peak_time, (p.peak_time - q.peak_time) * per_rounding);
    }
    const auto mine = totals_of(plain), others = totals_of(other);
    for (std::size_t i = 0; i < mine.size(); ++i)
      result.totals[i] = std::max(result.totals[i], magnitude(mine[i] - others[i]) * per_rounding);
  }
  result.growth.settle();
  // Until when is an error small?
  for (const Kind kind : {x_, v_, y_, w_})
    for (const auto& entry : result.growth.entries(kind)) {
      const auto at = std::lower_bound(result.sizes.times.begin(), result.sizes.times.end(), entry.time);
      if (result.sizes.times.empty()) break;
      const std::size_t i =
          std::min<std::size_t>(at - result.sizes.times.begin(), result.sizes.times.size() - 1);
      if (entry.difference <= predictable * result.sizes.most[kind][i]) continue;
      end_at(entry.time, "rounding has grown");
      break;
    }
  for (const auto& entry : result.growth.entries(time_))
    if (entry.difference > predictable * (1 + entry.time)) {
      end_at(entry.time, "rounding has grown");
      break;
    }
  return result;
}

Question question_of(const Scene& scene, const Engine& engine) {
  Question question;
  question.scene = scene;
  question.walls = std::holds_alternative<Restitution>(engine) ? Walls::rigid : Walls::compliant;
  if (const Exact* const exact = std::get_if<Exact>(&engine)) question.calibration = exact->calibration;
  return question;
}

class Judge {
 public:
  Judge(Comparison& result, const Prediction& prediction) : result_(result), prediction_(prediction) {}

  // `error` of a number of this size at this time; `predicted`: by growth. A value that was rounded once is
  // off by that, too.
  void number(const std::string& what, double value, Quad truth, Quad predicted) {
    ++result_.numbers;
    const Quad error = magnitude(Quad(value) - truth);
    const Quad unit = predicted + Quad(rounding) * magnitude(truth) + Quad(1e-300L);
    const double ratio = double(error / unit);
    if (!(ratio <= result_.worst)) result_.worst = ratio, result_.worst_what = what;
    if (!(ratio <= operations))
      differ(what + " is " + text(value, 17) + ", true " + text(truth, 20) + ", off by " + text(error, 3) +
             ", predicted " + text(unit, 3));
  }
  void differ(const std::string& what) { result_.differences.push_back(what); }

 private:
  Comparison& result_;
  const Prediction& prediction_;
};

}  // namespace

Comparison compare(const Scene& asked, const Engine& engine) {
  Comparison result;
  Scene scene = asked;
  result.asked = *scene.until_time;
  Question question = question_of(scene, engine);
  Prediction prediction = predict(question);
  for (int i = 0; i < 3 && prediction.ends; ++i) {
    result.ended_by = prediction.why;
    // Half a sample earlier: what ends it, and its noise, stay outside.
    const double end = double(*prediction.ends) - *scene.until_time / samples_of_a_run / 2;
    if (!(end > 0)) {
      result.until = 0;
      return result;
    }
    scene.until_time = question.scene.until_time = end;
    prediction = predict(question);
  }
  if (prediction.ends) return result;
  const double end = *scene.until_time;
  result.until = end;

  Record record;
  record.impacts = record.contacts = record.energy = true;
  record.history = {{0, end, samples_of_a_run}};
  Run run;
  Judge judge(result, prediction);
  try {
    run = simulate(scene, engine, record);
  } catch (const std::exception& error) {
    judge.differ(std::string("throws: ") + error.what());
    return result;
  }

  // The oracle at the engine's own samples and peaks.
  struct Wanted {
    double time;
    std::size_t index;
  };
  std::vector<double> times = run.history->time;
  for (const double t : run.half_cycles->peak_time)
    if (t >= 0 && t <= end) times.push_back(t);
  std::sort(times.begin(), times.end());
  question.samples = times;
  const Answer answer = answer_to(question);
  const auto at = [&](double t) -> const Sample& {
    const auto place = std::lower_bound(times.begin(), times.end(), t) - times.begin();
    return answer.samples.at(std::min<std::size_t>(place, answer.samples.size() - 1));
  };

  const Growth& growth = prediction.growth;
  // The sizes of what an engine adds up: it may round each.
  const auto size = [&](Kind kind, Quad t) {
    const auto& times_so_far = prediction.sizes.times;
    const auto place = std::lower_bound(times_so_far.begin(), times_so_far.end(), t) - times_so_far.begin();
    const auto& most = prediction.sizes.most[kind];
    return most[std::min<std::size_t>(place, most.size() - 1)];
  };
  const auto predicted = [&](Kind kind, Quad t) {
    Quad unit = growth(kind, t);
    // The force so far, as far as the primary mass follows it.
    const Quad omega_f = scene.force_frequency;
    const Quad force =
        std::abs(scene.force_amplitude) * std::min(Quad(1), omega_f * t) / std::max(Quad(1), omega_f);
    if (kind == x_ || kind == y_) unit += Quad(rounding) * (force + size(x_, t) + (kind == y_ ? 1 : 0));
    if (kind == v_ || kind == w_)
      unit += Quad(rounding) * force + Quad(rounding) * (size(v_, t) + (kind == w_ ? size(w_, t) : Quad(0)));
    if (kind == time_ || kind == peak_time_) unit += Quad(rounding) * t;
    return unit;
  };
  const auto negligible = [&](Kind kind) {
    return [&, kind](Quad t) {
      return Quad(operations) *
             (predicted(kind, t) + (kind == x_ ? predicted(time_, t) * size(v_, t) : Quad(0)));
    };
  };
  const Negligible below{negligible(time_), negligible(w_), negligible(x_)};

  Events mine = events_of(answer), its = events_of(run);
  const auto row_index = [](std::size_t i) { return "[" + std::to_string(i) + "]"; };
  simplify(mine, below), simplify(its, below);
  const Walk both = walk(mine, its, below);
  if (both.mismatch) judge.differ(both.what);
  const Quad until = both.mismatch ? *both.mismatch : Quad(end);

  std::vector<Quad> crossings;
  for (const HalfCycle& each : mine.rows) crossings.push_back(each.zero_crossing);
  for (const auto& [i, j] : both.impacts) {
    const oracle::Impact& p = mine.impacts[i];
    if (p.time > until) break;
    ++result.impacts;
    judge.number("impact time" + row_index(j), run.impacts->time[j], p.time, predicted(time_, p.time));
    judge.number("relative velocity" + row_index(j), run.impacts->relative_velocity[j], p.relative_velocity,
                 predicted(w_, p.time));
    if (!both.mismatch) {
      const Quad speed = magnitude(p.relative_velocity);
      const Quad relative_to_loss = speed > 0 ? p.loss / speed : Quad(0);
      judge.number("impact loss" + row_index(j), run.energy->impact_loss[j], p.loss,
                   growth(loss_, p.time) + 2 * relative_to_loss * predicted(w_, p.time));
    }
    // The half cycle, unless the impact coincides with a crossing.
    const Quad near = below.duration(p.time);
    const std::size_t row = std::lower_bound(crossings.begin(), crossings.end(), p.time) - crossings.begin();
    const bool coincides = (row < crossings.size() && crossings[row] - p.time <= near) ||
                           (row > 0 && p.time - crossings[row - 1] <= near);
    if (coincides || both.mismatch) continue;
    if (row == crossings.size()) {
      if (run.impacts->phase_deg[j] || run.impacts->amplitude[j])
        judge.differ("impact" + row_index(j) + " has a phase or an amplitude in an unfinished half cycle");
      continue;
    }
    if (run.impacts->amplitude[j])
      judge.number("impact's amplitude" + row_index(j), *run.impacts->amplitude[j], mine.rows[row].amplitude,
                   predicted(x_, crossings[row]));
    else
      judge.differ("impact" + row_index(j) + " has no amplitude");
    if (bool(run.impacts->phase_deg[j]) != (row > 0)) {
      judge.differ("impact" + row_index(j) + ": phase there or not");
    } else if (row > 0) {
      const Quad length = crossings[row] - crossings[row - 1];
      judge.number("phase" + row_index(j), *run.impacts->phase_deg[j],
                   180 * (p.time - crossings[row - 1]) / length,
                   360 / length * predicted(time_, crossings[row]));
    }
  }
  // Where the engine jumps to the end of a chattering it is off by up to its tolerance of what it jumps over.
  const auto jump = [&](Quad begin) {
    const Restitution* const rigid = std::get_if<Restitution>(&engine);
    Quad rest = 0;
    for (const std::size_t i : both.skipped)
      if (magnitude(*mine.impacts[i].accumulation - begin) <= below.duration(begin))
        rest = std::max(rest, begin - mine.impacts[i].time);
    return rigid ? rest * Quad(rigid->accumulation_tolerance) : Quad(0);
  };
  for (std::size_t i = 0; i < std::min(mine.contacts.size(), its.contacts.size()); ++i) {
    if (mine.contacts[i].begin > until) break;
    judge.number("contact begin" + row_index(i), double(its.contacts[i].begin), mine.contacts[i].begin,
                 predicted(time_, mine.contacts[i].begin) + jump(mine.contacts[i].begin));
    if (mine.contacts[i].end > until) break;
    judge.number("contact end" + row_index(i), double(its.contacts[i].end), mine.contacts[i].end,
                 predicted(time_, mine.contacts[i].end));
  }
  Quad last_crossing = 0;
  for (std::size_t i = 0; i < std::min(mine.rows.size(), its.rows.size()); ++i) {
    const HalfCycle &p = mine.rows[i], &q = its.rows[i];
    if (p.zero_crossing > until) break;
    judge.number("zero crossing" + row_index(i), double(q.zero_crossing), p.zero_crossing,
                 predicted(time_, p.zero_crossing));
    judge.number("amplitude" + row_index(i), double(q.amplitude), p.amplitude,
                 predicted(x_, p.zero_crossing));
    // Where two peaks of a row have one height, either will do.
    const bool another = magnitude(p.peak_time - q.peak_time) > Quad(1e-4L) * (1 + p.peak_time);
    if (another && q.peak_time >= last_crossing - below.duration(last_crossing) &&
        q.peak_time <= p.zero_crossing)
      judge.number("|x| at peak time" + row_index(i), double(p.amplitude),
                   magnitude(at(double(q.peak_time)).x), predicted(x_, p.zero_crossing));
    else
      judge.number("peak time" + row_index(i), double(q.peak_time), p.peak_time,
                   predicted(peak_time_, p.zero_crossing) + predicted(time_, p.zero_crossing));
    last_crossing = p.zero_crossing;
  }
  // The counts of the rows as they are recorded: impacts before the crossing, but for those that coincide
  // with it.
  for (std::size_t i = 0; i < run.half_cycles->impacts.size() && !both.mismatch; ++i) {
    const double crossing = run.half_cycles->zero_crossing[i];
    const double near = double(below.duration(crossing));
    std::int64_t sure = 0, possible = 0;
    std::int64_t before = 0;
    for (std::size_t n = 0; n <= i; ++n) before += run.half_cycles->impacts[n];
    for (const double t : run.impacts->time) {
      sure += t < crossing - near;
      possible += t <= crossing + near;
    }
    if (before < sure || before > possible)
      judge.differ("impacts up to row " + std::to_string(i) + ": " + std::to_string(before) + ", true " +
                   std::to_string(sure));
  }

  for (std::size_t i = 0; i < run.history->time.size(); ++i) {
    const double t = run.history->time[i];
    const Sample& truth = at(t);
    const std::string where = " at " + text(t, 17);
    const auto grown = [&](int k) {
      return i < prediction.samples.size() ? prediction.samples[i][k] : Quad(0);
    };
    // An impact within rounding of a sample: before or after it?
    bool coincides = false;
    for (const auto& each : mine.impacts)
      coincides = coincides || magnitude(each.time - t) <= below.duration(t);
    judge.number("x" + where, run.history->x[i], truth.x, grown(0) + predicted(x_, t));
    judge.number("y" + where, run.history->y[i], truth.y, grown(2) + predicted(y_, t));
    if (coincides) continue;
    judge.number("v" + where, run.history->v[i], truth.v, grown(1) + predicted(v_, t));
    judge.number("w" + where, run.history->w[i], truth.w, grown(3) + predicted(w_, t));
  }
  if (run.history->time != sample_times(end)) judge.differ("other samples than were asked for");

  // The ledger. Each term may be off by roundings of the largest.
  const EnergyLedger& ledger = *run.energy;
  Quad listed = 0, recorded = 0;
  for (const oracle::Impact& each : answer.impacts) listed += each.loss;
  for (const double each : ledger.impact_loss) recorded += each;
  const auto& totals = prediction.totals;
  const Quad all = answer.initial.total() + magnitude(answer.forcing_work) + answer.viscous_work;
  const Quad floor = Quad(rounding) * all;
  const auto energies = [&](const std::string& which, const impact_damper::Energy& e,
                            const oracle::Energy& truth, bool last) {
    const auto grown = [&](int i) { return last ? totals[i] + floor : Quad(0); };
    judge.number(which + " kinetic energy", e.kinetic, truth.kinetic, grown(0));
    judge.number(which + " spring energy", e.spring, truth.spring, grown(1));
    judge.number(which + " wall energy", e.wall, truth.wall, grown(2));
    judge.number(which + " paper's energy", e.paper, truth.paper, grown(3));
  };
  energies("initial", ledger.initial, answer.initial, false);
  energies("final", ledger.final, answer.final, true);
  judge.number("loss of all impacts", double(recorded + Quad(ledger.bounce_down_loss)),
               listed + answer.chatter_loss, totals[4] + totals[6] + floor);
  judge.number("contact loss", ledger.contact_loss, answer.contact_loss, totals[5] + floor);
  judge.number("viscous work", ledger.viscous_work, answer.viscous_work, totals[7] + floor);
  judge.number("forcing work", ledger.forcing_work, answer.forcing_work, totals[8] + floor);
  judge.number("residual", ledger.residual, 0, Quad(rounding) * 10);
  if (question.walls == Walls::rigid && !both.mismatch) {
    Quad jumped = answer.chatter_loss;
    for (const std::size_t i : both.skipped) jumped += mine.impacts[i].loss;
    judge.number("bounce-down loss", ledger.bounce_down_loss, jumped, totals[4] + totals[6] + floor);
  }
  judge.number("end time", run.end_time, end, 0);
  if (run.stop_reason != StopReason::time)
    judge.differ("stopped by " + std::string(name_of(run.stop_reason)));
  return result;
}

}  // namespace oracle
