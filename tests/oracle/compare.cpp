#include "compare.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <utility>

#include "impact_damper/simulate.hpp"
#include "shared_scenes.hpp"

namespace oracle {
namespace {

using namespace impact_damper;

// What an engine is off by in one operation, relative to the numbers in it; a size of noise at which growth
// is still to be linear; and up to which predicted error, relative to its size, a number is compared.
struct Accuracy {
  double rounding, noise, predictable, operations;
  bool by_steps = false;
};
constexpr Accuracy closed_forms{0x1p-53, 4 * 0x1p-53, 1e-7, operations};
// Central differences with a hundred steps for each contact or period: (2 pi / 200)^2 / 24 and more.
constexpr Accuracy central_differences{1e-5, 1e-5, 1e-2, 3, true};
// The first step is a hundredth of half a contact, as the engine's own default is; it is divided by these
// where that is not short enough, and each of them by 4 for the order.
constexpr std::array<double, 3> finer_steps{1, 4, 16};
double first_step(const Scene& scene) {
  double shortest = std::min(1.0, scene.force_amplitude != 0 ? 1 / scene.force_frequency : 1.0);
  for (const SceneDamper& each : scene.dampers)
    shortest = std::min(shortest, std::sqrt(each.mass_ratio / (each.wall_stiffness * (1 + each.mass_ratio))));
  return std::numbers::pi / 100 * shortest;
}

// Rigid walls and several dampers: a damper's chattering may begin anew at each impact of another one. The
// engine takes its end at once; contacts as near to each other as this, times 1 + t, are then one, and the
// begin of sticking may be off by three times that, in a chattering within another one by thirty times.
// Impacts so shortly before sticking, times 1 + t, and so slow, need not be listed.
constexpr double sticking_begin = 1e-7, chattering_time = 1e-3, chattering_speed = 1e-5;

// Of a comparison.
struct Setting {
  Question question;
  Accuracy accuracy;
  bool nested = false;  // rigid walls, several dampers
  const Scene& scene() const { return question.scene; }
  int dampers() const { return int(question.scene.dampers.size()); }
};

// As the engines' recorder places them.
std::vector<double> sample_times(double end, int count = sample_count) {
  std::vector<double> times;
  for (int i = 0; i < count; ++i) times.push_back(i + 1 < count ? double(i) / (count - 1) * end : end);
  return times;
}

// What has a growth of its own; `unknown`: has none.
enum Kind { time_, peak_time_, x_, v_, y_, w_, loss_, kinds_, unknown };

// The events of a run, and its motion, in the oracle's form.
Answer answer_of(const Run& run) {
  Answer answer;
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
    Sample& sample = answer.samples.emplace_back(Sample{run.history->x[i], run.history->v[i], {}, {}});
    for (const History::Damper& each : run.history->dampers)
      sample.y.push_back(each.y.at(i)), sample.w.push_back(each.w.at(i));
  }
  return answer;
}

// The terms of the energy balance, each with its name. Those of friction, weight and drag are of scenes that
// have any of them.
struct Term {
  std::string name;
  Quad value;
  bool initial = false;
};
template <class Each>
void add_energy(std::vector<Term>& terms, const std::string& when, const Each& now, const Setting& setting) {
  const bool initial = when == "initial";
  terms.push_back({when + " kinetic energy", now.kinetic, initial});
  terms.push_back({when + " spring energy", now.spring, initial});
  terms.push_back({when + " wall energy", now.wall, initial});
  terms.push_back({when + " paper's energy", now.paper, initial});
  if (has_components(setting.scene())) terms.push_back({when + " energy of weight", now.weight, initial});
}
void add_losses(std::vector<Term>& terms, const Setting& setting, Quad impacts, Quad contacts) {
  if (setting.accuracy.by_steps) {
    // A contact that begins without speed may begin with an impact here: only the sum is known.
    terms.push_back({"all losses", impacts + contacts});
  } else {
    terms.push_back({"loss of all impacts", impacts});
    terms.push_back({"contact loss", contacts});
  }
}
template <class Each>
void add_resistance(std::vector<Term>& terms, const std::string& whose, const Each& its,
                    const Setting& setting) {
  if (!has_components(setting.scene())) return;
  terms.push_back({whose + "friction loss", its.friction_loss});
  terms.push_back({whose + "drag loss", its.drag_loss});
}
template <class Each>
void add_damper(std::vector<Term>& terms, std::size_t number, Quad initial, Quad final, Quad loss,
                const Each& its, const Setting& setting) {
  const std::string which = "damper " + std::to_string(number);
  add_resistance(terms, which + ' ', its, setting);
  terms.push_back({which + " initial energy", initial, true});
  terms.push_back({which + " final energy", final});
  terms.push_back({which + " loss", loss});
}
std::vector<Term> terms_of(const Answer& answer, const Setting& setting) {
  std::vector<Term> terms{{"viscous work", answer.viscous_work}, {"forcing work", answer.forcing_work}};
  add_energy(terms, "initial", answer.initial, setting);
  add_energy(terms, "final", answer.final, setting);
  const DamperEnergy all{.friction_loss = answer.sum(&DamperEnergy::friction_loss),
                         .drag_loss = answer.sum(&DamperEnergy::drag_loss)};
  add_resistance(terms, "", all, setting);
  add_losses(terms, setting, answer.impact_loss() + answer.sum(&DamperEnergy::chatter_loss),
             answer.sum(&DamperEnergy::contact_loss));
  for (std::size_t n = 0; n < answer.dampers.size(); ++n) {
    const DamperEnergy& its = answer.dampers[n];
    Quad loss = its.contact_loss + its.chatter_loss;
    for (const Impact& each : answer.impacts)
      if (each.damper == int(n)) loss += each.loss;
    add_damper(terms, n, its.initial, its.final, loss, its, setting);
  }
  return terms;
}
// Of a run without those of its dampers, if it has none.
std::vector<Term> terms_of(const EnergyBalance& energy, const Setting& setting) {
  std::vector<Term> terms{{"viscous work", energy.viscous_work}, {"forcing work", energy.forcing_work}};
  add_energy(terms, "initial", energy.initial, setting);
  add_energy(terms, "final", energy.final, setting);
  add_resistance(terms, "", energy, setting);
  Quad impacts = energy.bounce_down_loss;
  for (const double each : energy.impact_loss) impacts += each;
  add_losses(terms, setting, impacts, energy.contact_loss);
  for (std::size_t n = 0; n < energy.dampers.size(); ++n) {
    const auto& its = energy.dampers[n];
    add_damper(terms, n, its.initial_kinetic, its.final_kinetic,
               Quad(its.impact_loss) + its.contact_loss + its.bounce_down_loss, its, setting);
  }
  return terms;
}

// Below these nothing can be said of an event: it is there or not by rounding.
struct Negligible {
  std::function<Quad(Quad)> duration, speed, length;
};

// Where events coincide, rounding decides whether a contact of no length is recorded, and whether one is cut
// in two by a touch: such are taken out. `within`: others come shortly before, so that its begin depends on
// what is called no length.
struct Held : Contact {
  bool within = false;
};
std::vector<Held> contacts_of(const Answer& answer, int damper, const Setting& setting,
                              const Negligible& below) {
  const auto nothing = [&](Quad t) {
    if (setting.dampers() == 1) return below.duration(t);
    return setting.nested ? Quad(sticking_begin) * (1 + t) : Quad(0);
  };
  std::vector<Held> contacts;
  std::optional<Contact> last;
  for (const Contact& each : answer.contacts) {
    if (each.damper != damper) continue;
    const bool same = last && last->wall == each.wall;
    if (!contacts.empty() && contacts.back().wall == each.wall &&
        each.begin - contacts.back().end <= nothing(each.begin)) {
      contacts.back().end = each.end, contacts.back().end_speed = each.end_speed;
      contacts.back().within = true;
    } else {
      contacts.push_back({each, same && each.begin - last->end <= 10 * nothing(each.begin)});
    }
    last = each;
  }
  std::erase_if(contacts, [&](const Held& each) { return each.end - each.begin <= nothing(each.begin); });
  return contacts;
}

// Rounding decides whether a touch of x = 0 is two crossings or none: such are taken out, too. `merged`: it
// was three.
struct Row : HalfCycle {
  bool merged = false;
};
std::vector<Row> rows_of(const Answer& answer, const Negligible& below) {
  const auto& all = answer.half_cycles;
  std::vector<Row> rows;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const HalfCycle& each = all[i];
    // Not the first row: how small it is is exactly known.
    const Quad length = i > 0 ? each.zero_crossing - all[i - 1].zero_crossing : each.zero_crossing;
    const Quad least = below.length(each.zero_crossing);
    // As long as a parabola that high, at most.
    if (i > 0 && i + 1 < all.size() && each.amplitude <= least && length * length <= 16 * least) {
      const HalfCycle& next = all[++i];
      Row& last = rows.back();
      last.zero_crossing = next.zero_crossing, last.speed = next.speed;
      if (next.amplitude > last.amplitude) last.amplitude = next.amplitude, last.peak_time = next.peak_time;
      last.merged = true;
      continue;
    }
    rows.push_back({each});
  }
  return rows;
}

std::string side_of(Wall wall) { return wall == Wall::left ? "left " : "right "; }
std::string said(const Impact& each) {
  return side_of(each.wall) + text(each.time, 17) + " (" + text(each.relative_velocity, 6) + ")";
}
std::string said(const Contact& each) {
  return side_of(each.wall) + text(each.begin, 17) + " to " + text(each.end, 17);
}
std::string said(const HalfCycle& each) { return text(each.zero_crossing, 17); }
template <class T>
std::string said(const std::vector<T>& all, std::size_t i) {
  return i < all.size() ? said(all[i]) : "none";
}

// Two answers side by side.
struct Walk {
  std::vector<std::array<std::size_t, 2>> impacts;  // of the first, of the second answer
  std::vector<bool> rough;           // of these: need not be listed, so that only the time counts
  std::vector<std::size_t> skipped;  // of the first: jumped over by the second
  std::int64_t jumps = 0;
  struct Pair {
    Held mine, its;
  };
  std::vector<Pair> contacts;
  std::vector<Row> my_rows, its_rows;
  std::optional<Quad> mismatch;  // the first time at which they are not the same
  std::string what;
  template <class T>
  void fail(Quad t, const std::string& which, std::size_t n, const T& mine, const T& its) {
    if (mismatch && t >= *mismatch) return;
    mismatch = t;
    what = which + std::to_string(n) + ": " + said(its, n) + " where the oracle has " + said(mine, n);
  }
};

class Walker {
 public:
  Walker(const Answer& a, const Answer& b, const Setting& setting, const Negligible& below)
      : a_(a), b_(b), setting_(setting), below_(below) {}

  Walk walk() {
    for (int damper = 0; damper < setting_.dampers(); ++damper) {
      name_ = setting_.dampers() == 1 ? "" : "damper " + std::to_string(damper) + ' ';
      my_contacts_ = contacts_of(a_, damper, setting_, below_);
      its_contacts_ = contacts_of(b_, damper, setting_, below_);
      walk_impacts(damper);
      walk_contacts();
    }
    walk_rows();
    return std::move(both_);
  }

 private:
  using Impacts = std::vector<Impact>;
  Quad window(Quad t) const { return std::max(Quad(1e-7L) * (1 + t), below_.duration(t)); }

  // Number n of one damper's impacts need not be listed.
  bool omitted(const Impacts& all, std::size_t n) const {
    const Impact& each = all[n];
    const Quad speed = magnitude(each.relative_velocity);
    if (speed <= below_.speed(each.time)) return true;
    if (!setting_.nested) return false;
    if (!each.impulse) return true;
    const Quad near = Quad(sticking_begin) * (1 + each.time);
    // The end of a chattering that is cut short by another damper's.
    if (n > 0 && speed <= Quad(1e-7L) && all[n - 1].wall == each.wall && each.time - all[n - 1].time <= near)
      return true;
    return speed <= Quad(chattering_speed) &&
           std::any_of(my_contacts_.begin(), my_contacts_.end(), [&](const Contact& contact) {
             return contact.wall == each.wall && each.time <= contact.end + near &&
                    contact.begin - each.time <= Quad(chattering_time) * (1 + each.time);
           });
  }

  void walk_impacts(int damper) {
    std::vector<std::size_t> my_numbers, its_numbers;
    const auto of_damper = [damper](const Answer& answer, std::vector<std::size_t>& numbers) {
      Impacts its;
      for (std::size_t i = 0; i < answer.impacts.size(); ++i)
        if (answer.impacts[i].damper == damper) its.push_back(answer.impacts[i]), numbers.push_back(i);
      return its;
    };
    const Impacts mine = of_damper(a_, my_numbers), its = of_damper(b_, its_numbers);
    std::size_t i = 0, j = 0;
    // In a chattering impacts are near each other: the nearest is the same one.
    const auto next_is_nearer = [](const Impacts& in, std::size_t n, const Impact& to) {
      return n + 1 < in.size() && in[n + 1].wall == to.wall &&
             magnitude(in[n + 1].time - to.time) < magnitude(in[n].time - to.time);
    };
    while (i < mine.size() || j < its.size()) {
      const bool have_mine = i < mine.size(), have_its = j < its.size();
      if (setting_.nested && have_mine && have_its) {
        if (omitted(mine, i) && next_is_nearer(mine, i, its[j])) {
          ++i;
          continue;
        }
        if (omitted(its, j) && next_is_nearer(its, j, mine[i])) {
          ++j;
          continue;
        }
      }
      // How near is judged by the numbers' comparison.
      if (have_mine && have_its && mine[i].wall == its[j].wall) {
        const auto &p = mine[i], &q = its[j];
        // In a chattering within another one alike impacts are nearer to each other.
        const Quad w = magnitude(p.relative_velocity),
                   off = magnitude(p.relative_velocity - q.relative_velocity);
        const bool nested = setting_.nested;
        const bool alike =
            off <= (nested ? std::max(w * Quad(1e-3L), Quad(1e-14L)) : w / 2 + below_.speed(p.time));
        const bool other_is_nearer = !nested && next_is_nearer(mine, i, q);
        // Of those that need not be listed others may be left out.
        const Quad near = !nested                               ? window(p.time)
                          : omitted(mine, i) && omitted(its, j) ? Quad(sticking_begin) * (1 + p.time)
                                                                : Quad(1e-6L) * (1 + p.time);
        if (magnitude(p.time - q.time) <= near && alike && !other_is_nearer) {
          both_.rough.push_back(setting_.nested && omitted(mine, i) && omitted(its, j));
          both_.impacts.push_back({my_numbers[i++], its_numbers[j++]});
          continue;
        }
      }
      if (have_mine && omitted(mine, i)) {
        ++i;
        continue;
      }
      if (have_its && omitted(its, j)) {
        ++j;
        continue;
      }
      // The rest of a complete chattering, that the other one jumps over.
      const auto rest_of = [&](const Impacts& in, std::size_t n, const Impacts& other, std::size_t m) {
        std::size_t end = n;
        if (setting_.nested || n == in.size() || !in[n].accumulation) return end;
        const Quad last = *in[n].accumulation;
        if (m < other.size() && other[m].time <= last - below_.duration(last)) return end;
        while (end < in.size() && in[end].accumulation && *in[end].accumulation == last) ++end;
        return end;
      };
      if (const std::size_t end = rest_of(mine, i, its, j); end > i) {
        for (; i < end; ++i) both_.skipped.push_back(my_numbers[i]);
        ++both_.jumps;
        continue;
      }
      if (const std::size_t end = rest_of(its, j, mine, i); end > j) {
        j = end;
        continue;
      }
      const Quad t = !have_its || (have_mine && mine[i].time < its[j].time) ? mine[i].time : its[j].time;
      const Impacts one = have_mine ? Impacts{mine[i]} : Impacts{},
                    other = have_its ? Impacts{its[j]} : Impacts{};
      both_.fail(t, name_ + "impact " + std::to_string(i) + '.', 0, one, other);
      return;
    }
  }

  void walk_contacts() {
    for (std::size_t n = 0; n < std::max(my_contacts_.size(), its_contacts_.size()); ++n) {
      const auto fail = [&](Quad t) { both_.fail(t, name_ + "contact ", n, my_contacts_, its_contacts_); };
      if (n >= my_contacts_.size()) return fail(its_contacts_[n].begin);
      if (n >= its_contacts_.size()) return fail(my_contacts_[n].begin);
      const Held &p = my_contacts_[n], &q = its_contacts_[n];
      const Quad begin = std::min(p.begin, q.begin), end = std::min(p.end, q.end);
      const Quad near = setting_.nested ? Quad(1e-5L) * (1 + begin) : window(begin);
      if (p.wall != q.wall || magnitude(p.begin - q.begin) > near) return fail(begin);
      both_.contacts.push_back({p, q});
      if (magnitude(p.end - q.end) > window(end)) return fail(end);
    }
  }

  void walk_rows() {
    both_.my_rows = rows_of(a_, below_), both_.its_rows = rows_of(b_, below_);
    const auto &mine = both_.my_rows, &its = both_.its_rows;
    for (std::size_t n = 0; n < std::max(mine.size(), its.size()); ++n) {
      const auto fail = [&](Quad t) { both_.fail(t, "crossing ", n, mine, its); };
      if (n >= mine.size()) return fail(its[n].zero_crossing);
      if (n >= its.size()) return fail(mine[n].zero_crossing);
      const Quad t = std::min(mine[n].zero_crossing, its[n].zero_crossing);
      if (magnitude(mine[n].zero_crossing - its[n].zero_crossing) > window(t)) return fail(t);
    }
  }

  const Answer &a_, &b_;
  const Setting& setting_;
  const Negligible& below_;
  std::vector<Held> my_contacts_, its_contacts_;
  std::string name_;
  Walk both_;
};

// The largest error that rounding made so far, for each kind; for a rounding of 2^-53.
class Growth {
 public:
  void take(Kind kind, Quad time, Quad difference) {
    if (kind < kinds_) entries_[kind].push_back({time, magnitude(difference)});
  }
  void accumulate() {
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
  std::vector<Quad> terms;                   // of the energy balance
  void end_at(Quad t, const std::string& reason) {
    if (!ends || t < *ends) ends = t, why = reason;
  }
};

// The predicted errors of one run.
class Units {
 public:
  Units(const Setting& setting, const Prediction& prediction, const Run& run)
      : setting_(setting), prediction_(prediction), rounding_(setting.accuracy.rounding) {
    // Central differences take a step for an instant, at the release too.
    if (const Cem* const cem = std::get_if<Cem>(&run.engine); cem && setting.accuracy.by_steps)
      instant_ = cem->time_step.value_or(0);
    for (const SceneDamper& each : setting.scene().dampers) {
      masses_ += each.mass_ratio;
      widest_ = std::max(widest_, Quad(each.clearance));
    }
  }
  Quad growth(Kind kind, Quad t) const { return prediction_.growth(kind, t); }
  Quad size(Kind kind, Quad t) const {
    const auto& times = prediction_.sizes.times;
    const auto place = std::size_t(std::lower_bound(times.begin(), times.end(), t) - times.begin());
    const auto& most = prediction_.sizes.most[kind];
    return most[std::min(place, most.size() - 1)];
  }
  // Whatever an engine adds up it may round, and x, v and the force so far are what the primary mass's motion
  // is added up of; a secondary mass's place is so near a wall of the cavity as its clearance can be rounded.
  Quad motion(Quad t) const {
    const Quad omega_f = setting_.scene().force_frequency;
    const Quad force = std::abs(setting_.scene().force_amplitude) * std::min(Quad(1), omega_f * t) /
                       std::max(Quad(1), omega_f);
    const Quad given = masses_ / (1 + masses_) * size(w_, t);  // by the secondary masses
    return rounding_ * (force + given + size(x_, t) + size(v_, t));
  }
  Quad place() const { return rounding_ * widest_; }
  Quad predicted(Kind kind, Quad t) const {
    Quad unit = growth(kind, t);
    if (kind == time_ || kind == peak_time_) return unit + rounding_ * t + instant_;
    unit += motion(t);
    if (kind == y_) unit += place();
    if (kind == w_) unit += rounding_ * size(w_, t);
    return unit;
  }
  // Of the loss of an impact on a rigid wall beside others, by (M17.4): the impulse is nu times a difference
  // of speeds as large as that of the impact, however little of it is left between two masses of which one is
  // much heavier.
  Quad of_impulse(int damper, Quad speed) const {
    const Scene& scene = setting_.scene();
    if (setting_.question.walls != Walls::rigid) return 0;
    return rounding_ * scene.dampers[std::size_t(damper)].mass_ratio * speed * speed;
  }
  // A place that is off by so much is met at this speed.
  Quad met(Quad t, Quad place, Quad speed) const {
    return predicted(time_, t) + (speed != 0 ? place / magnitude(speed) : Quad(0));
  }
  // The place, or at rigid walls the acceleration, that has to vanish at a contact's end.
  Quad release(Quad t) const {
    return setting_.question.walls == Walls::rigid ? motion(t) * (1 + 2 * setting_.scene().damping_ratio)
                                                   : place();
  }
  Negligible negligible() const {
    const auto of = [this](Kind kind) {
      return [this, kind](Quad t) {
        Quad unit = predicted(kind, t);
        if (kind == x_) unit += predicted(time_, t) * size(v_, t);
        if (kind == w_) unit += within_step(t);
        return setting_.accuracy.operations * unit;
      };
    };
    return {of(time_), of(w_), of(x_)};
  }

 private:
  // What an acceleration gives in a step that was zero at its begin.
  Quad within_step(Quad t) const {
    const Scene& scene = setting_.scene();
    const Quad grows = std::abs(scene.force_amplitude) * scene.force_frequency + size(x_, t) + size(v_, t);
    return instant_ * instant_ * grows;
  }
  const Setting& setting_;
  const Prediction& prediction_;
  const Quad rounding_;
  Quad instant_ = 0, masses_ = 0, widest_ = 1;
};

// A number of both answers; `unit`, the predicted error, is asked for in runs only.
struct Number {
  std::string what;
  Kind kind;
  Quad at, mine, its;
  std::function<Quad(const Units&)> unit;
};
using Take = std::function<void(const Number&)>;

std::string row_index(std::size_t i) { return "[" + std::to_string(i) + "]"; }
bool same_peak(const HalfCycle& p, const HalfCycle& q) {  // two peaks of one height may change places
  return magnitude(p.peak_time - q.peak_time) < Quad(1e-4L) * (1 + p.peak_time);
}

// All numbers of the events that both answers have.
void numbers_of_events(const Answer& a, const Answer& b, const Walk& both, const Setting& setting,
                       const Take& take) {
  const auto beyond = [&](Quad t) { return both.mismatch && t >= *both.mismatch; };
  // What bounces on beside those whose chattering has been replaced by its limit is where it would be except
  // for epsilon |x| / 8 (17.3). That is all of it, not one of `operations`.
  const auto left_off = [&](const Impact& impact) {
    const Quad t = impact.time;
    const bool beside =
        setting.nested && std::any_of(a.contacts.begin(), a.contacts.end(), [&](const Contact& each) {
          return each.damper != impact.damper && each.wall == impact.wall && t <= each.end &&
                 each.begin - t <= Quad(sticking_begin) * (1 + t);
        });
    return beside ? Quad(0x1p-52 / 8 / operations) * magnitude(impact.displacement) : Quad(0);
  };
  for (std::size_t n = 0; n < both.impacts.size(); ++n) {
    const auto [i, j] = both.impacts[n];
    const Impact &p = a.impacts[i], &q = b.impacts[j];
    if (beyond(p.time)) continue;
    const Quad t = p.time, w = p.relative_velocity;
    if (both.rough[n]) {
      take({"impact time" + row_index(j), unknown, t, t, q.time,
            [=](const Units&) { return Quad(sticking_begin / operations) * (1 + t); }});
      continue;
    }
    const Quad off = left_off(p),
               speed_off = off != 0 && w != 0 ? off * p.acceleration / magnitude(w) : Quad(0);
    const auto met = [=](const Units& units) { return units.met(t, units.place() + off, w); };
    const auto speed = [=](const Units& units) { return units.predicted(w_, t) + speed_off; };
    take({"impact time" + row_index(j), time_, t, t, q.time, met});
    take({"relative velocity" + row_index(j), w_, t, w, q.relative_velocity, speed});
    // It goes on while the time errs.
    take({"displacement" + row_index(j), x_, t, p.displacement, q.displacement,
          [=](const Units& units) { return units.predicted(x_, t) + units.size(v_, t) * met(units); }});
    take({"impact loss" + row_index(j), loss_, t, p.loss, q.loss, [=, loss = p.loss](const Units& units) {
            const Quad by_speed = w != 0 ? loss / magnitude(w) : Quad(0);
            return units.growth(loss_, t) + 2 * by_speed * speed(units) + units.of_impulse(p.damper, w);
          }});
  }
  const auto speed_at = [&](const Held& contact) {
    for (const Impact& each : a.impacts)
      if (each.damper == contact.damper && each.time == contact.begin) return each.relative_velocity;
    return Quad(0);
  };
  // The impact of another damper that throws one off its rigid wall: its speed, and left_off().
  const auto thrown_off = [&](const Held& contact) {
    for (const Impact& each : a.impacts)
      if (setting.nested && each.damper != contact.damper && each.time == contact.end)
        return std::array{each.relative_velocity, left_off(each)};
    return std::array{Quad(0), Quad(0)};
  };
  // Where the engine jumps to the end of a chattering it is off by up to its tolerance of what it jumps over.
  const auto jump = [&](const Held& contact) {
    Quad rest = 0;
    for (const std::size_t i : both.skipped)
      if (a.impacts[i].damper == contact.damper &&
          magnitude(*a.impacts[i].accumulation - contact.begin) <= Quad(1e-9L) * (1 + contact.begin))
        rest = std::max(rest, contact.begin - a.impacts[i].time);
    return rest * Quad(Restitution{}.accumulation_tolerance);
  };
  for (std::size_t n = 0; n < both.contacts.size(); ++n) {
    const auto& [p, q] = both.contacts[n];
    const Quad begin = p.begin, end = p.end;
    if (beyond(begin)) continue;
    const std::string which = " of damper " + std::to_string(p.damper) + row_index(n);
    if (setting.nested)
      take({"contact begin" + which, unknown, begin, begin, q.begin,
            [=, within = p.within || q.within](const Units&) {
              return Quad((within ? 30 : 3) * sticking_begin / operations) * (1 + begin);
            }});
    else
      take({"contact begin" + which, time_, begin, begin, q.begin,
            [=, speed = speed_at(p), jumped = jump(p)](const Units& units) {
              return units.met(begin, units.place(), speed) + jumped;
            }});
    if (beyond(end)) continue;
    take({"contact end" + which, time_, end, end, q.end,
          [=, speed = p.end_speed, struck = thrown_off(p)](const Units& units) {
            return struck[0] != 0 ? units.met(end, units.place() + struck[1], struck[0])
                                  : units.met(end, units.release(end), speed);
          }});
  }
  for (std::size_t n = 0; n < std::min(both.my_rows.size(), both.its_rows.size()); ++n) {
    const Row &p = both.my_rows[n], &q = both.its_rows[n];
    const Quad t = p.zero_crossing;
    if (beyond(t)) break;
    take({"zero crossing" + row_index(n), time_, t, t, q.zero_crossing,
          [=, speed = p.speed](const Units& units) { return units.met(t, units.motion(t), speed); }});
    take({"amplitude" + row_index(n), x_, t, p.amplitude, q.amplitude,
          [=](const Units& units) { return units.predicted(x_, t); }});
    // The release and the turn right after it may be the peak, too: see judge_other_peaks.
    if (same_peak(p, q) && (n > 0 || q.peak_time != 0))
      take({"peak time" + row_index(n), peak_time_, p.peak_time, p.peak_time, q.peak_time,
            [=](const Units& units) { return units.predicted(peak_time_, t) + units.predicted(time_, t); }});
  }
}

Prediction predict(const Setting& setting) {
  const auto [rounding, probe, predictable, most, by_steps] = setting.accuracy;
  struct Noise {
    double size;
    std::uint64_t seed;
  };
  // The second is the first with the opposite sign: where rounding alone decides, as of a wall that is just
  // touched, one of both decides otherwise.
  std::vector<Noise> noises{{1e-24, 1}, {-1e-24, 1}, {probe, 3}};
  if (setting.dampers() == 1) noises.push_back({1e-24, 2});
  // What rounding decides central differences decide in one way or the other, with any step.
  if (by_steps) noises.push_back({closed_forms.noise, 3}), noises.push_back({-closed_forms.noise, 3});
  Prediction result;
  Question question = setting.question;
  const Scene& scene = setting.scene();
  const double end = *scene.until_time;
  question.samples = sample_times(end);
  result.answer = answer_to(question);
  const Answer& plain = result.answer;
  result.growth.slack = end / sample_count;
  if (!plain.complete()) {
    result.end_at(plain.end_time, "the oracle's effort");
    return result;
  }
  // The mass may be on a wall and off it again within the finest step.
  for (const Contact& each : plain.contacts)
    if (by_steps && each.end - each.begin < first_step(scene) / finer_steps.back() / 4 && each.end < end)
      result.end_at(each.begin, "a contact shorter than a step");
  // Chattering that ends where friction would hold the mass as well: whether it then lies on its wall or
  // stands above it, by less than rounding, depends on who else is in the air as it turns.
  for (std::size_t i = 0; setting.nested && i < plain.contacts.size(); ++i) {
    const Contact& each = plain.contacts[i];
    const Quad near = Quad(sticking_begin) * (1 + each.begin);
    for (std::size_t n = 0; n < i && each.by_friction; ++n) {
      const Contact& before = plain.contacts[n];
      if (before.damper == each.damper && before.wall == each.wall && each.begin - before.end <= near)
        result.end_at(before.begin, "rounding decides: held on a wall or above it");
    }
  }
  // Impacts on left and right walls that follow each other within rounding of their times: whether a mass
  // rests on its wall when the next one comes, or is a hair from it, is then no property of the scene in
  // double precision.
  for (std::size_t i = 1; setting.nested && i < plain.impacts.size(); ++i) {
    const Impact &before = plain.impacts[i - 1], &each = plain.impacts[i];
    if (each.wall != before.wall && each.time > before.time &&
        each.time - before.time <= Quad(4 * rounding) * (1 + each.time))
      result.end_at(before.time, "rounding decides: left and right walls at one instant");
  }
  result.samples.resize(question.samples.size());
  const auto largest = [](const std::vector<Quad>& all) {
    Quad most_of_all = 0;
    for (const Quad each : all) most_of_all = std::max(most_of_all, magnitude(each));
    return most_of_all;
  };

  // Sizes so far, of each kind.
  Quad x = magnitude(scene.x0), v = magnitude(scene.v0), y = 0, w = 0;
  for (std::size_t i = 0; i < plain.samples.size(); ++i) {
    const Sample& each = plain.samples[i];
    x = std::max(x, magnitude(each.x)), v = std::max(v, magnitude(each.v));
    y = std::max(y, largest(each.y)), w = std::max(w, largest(each.w));
    const Quad t = question.samples[i];
    result.sizes.times.push_back(t);
    const std::array<Quad, kinds_> now{t, t, x, v, y, w, v * v + x * x};
    for (int k = 0; k < kinds_; ++k) result.sizes.most[k].push_back(now[k]);
  }

  const std::vector<Term> terms = terms_of(plain, setting);
  result.terms.resize(terms.size());
  // A scene that needs all the effort needs a little more when it is changed.
  question.most_steps += question.most_steps / 10, question.most_impacts += question.most_impacts / 10;
  for (const Noise& noise : noises) {
    question.noise = noise.size;
    question.seed = noise.seed;
    const Answer other = answer_to(question);
    const Quad size = magnitude(noise.size), per_rounding = Quad(rounding) / size;
    const std::size_t samples = std::min(plain.samples.size(), other.samples.size());
    if (!other.complete()) result.end_at(other.end_time, "the oracle's effort");
    // Events: what is negligible is so by this noise alone.
    std::vector<Quad> places, speeds;  // largest differences so far
    for (std::size_t i = 0; i < samples; ++i) {
      const Quad t = question.samples[i];
      const Sample &a = plain.samples[i], &b = other.samples[i];
      std::array<Quad, 4> off{magnitude(a.x - b.x), magnitude(a.v - b.v), 0, 0};
      for (std::size_t n = 0; n < a.y.size(); ++n) {
        off[2] = std::max(off[2], magnitude(a.y[n] - b.y[n]));
        off[3] = std::max(off[3], magnitude(a.w[n] - b.w[n]));
      }
      places.push_back(std::max(off[0] + off[2], i > 0 ? places.back() : Quad(0)));
      speeds.push_back(std::max(off[1] + off[3], i > 0 ? speeds.back() : Quad(0)));
      for (int k = 0; k < 4; ++k)
        result.samples[i][k] = std::max(result.samples[i][k], off[k] * per_rounding);
      // A contact's velocities change fast: off by as much as the time of its begin, they are so only there.
      if (a.in_contact || b.in_contact) continue;
      for (int k = 0; k < 4; ++k) result.growth.take(Kind(x_ + k), t, off[k] * per_rounding);
    }
    const auto grown = [&](const std::vector<Quad>& so_far) {
      return [&](Quad t) {
        const auto after = std::upper_bound(question.samples.begin(), question.samples.end(), t,
                                            [](Quad time, double sample) { return time < Quad(sample); });
        const auto i = std::min(std::size_t(after - question.samples.begin()), samples - 1);
        return 1000 * ((samples > 0 ? so_far[i] : Quad(0)) + size * (t + 1));
      };
    };
    const Negligible below{grown(places), grown(speeds), grown(places)};
    const Walk both = Walker(plain, other, setting, below).walk();
    if (both.mismatch) result.end_at(*both.mismatch, "rounding decides: " + both.what);
    numbers_of_events(plain, other, both, setting, [&](const Number& each) {
      result.growth.take(each.kind, each.at, (each.mine - each.its) * per_rounding);
    });
    const std::vector<Term> others = terms_of(other, setting);
    for (std::size_t i = 0; i < terms.size(); ++i)
      result.terms[i] = std::max(result.terms[i], magnitude(terms[i].value - others[i].value) * per_rounding);
  }
  result.growth.accumulate();
  // Until when is an error small?
  for (const Kind kind : {time_, x_, v_, y_, w_})
    for (const auto& entry : result.growth.entries(kind)) {
      const auto& times = result.sizes.times;
      const auto at = std::size_t(std::lower_bound(times.begin(), times.end(), entry.time) - times.begin());
      const Quad size =
          kind == time_ ? 1 + entry.time : result.sizes.most[kind][std::min(at, times.size() - 1)];
      if (entry.difference <= predictable * size) continue;
      result.end_at(entry.time, "rounding has grown");
      break;
    }
  return result;
}

// Is told of each number that is compared, and of what is there and should not be, or the other way about.
struct Judge {
  std::function<void(const std::string& what, double value, Quad truth, Quad predicted)> number;
  std::function<void(const std::string& what)> differ;
};

// The order of the impacts in a run, and the times of those that coincide.
void judge_order(const Run& run, const Answer& answer, Walls walls, const Judge& judge) {
  const impact_damper::Impacts& impacts = *run.impacts;
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
    if (t < next || (t == next && (run.scene.dampers.size() == 1 ||
                                   impacts.damper[i] < impacts.damper[i + 1] || !one_instant(i, i + 1))))
      continue;
    judge.differ("impacts " + std::to_string(i) + " and the next are not in order: damper " +
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
      judge.differ("impacts of one instant have two times: " + said(p) + " and " + said(q));
  }
}

// The counts of the rows as they are recorded: impacts before the crossing, but for those that coincide with
// it.
void judge_counts(const Run& run, const Negligible& below, const Judge& judge) {
  const HalfCycles& rows = *run.half_cycles;
  const std::size_t count = run.scene.dampers.size();
  if (rows.dampers.size() != count)
    return judge.differ("half cycles have impacts of " + std::to_string(rows.dampers.size()) + " dampers");
  std::vector<std::int64_t> before(count, 0);
  for (std::size_t row = 0; row < rows.zero_crossing.size(); ++row) {
    std::int64_t all = 0;
    const double crossing = rows.zero_crossing[row], near = double(below.duration(crossing));
    for (std::size_t damper = 0; damper < count; ++damper) {
      all += rows.dampers[damper].impacts.at(row);
      before[damper] += rows.dampers[damper].impacts[row];
      std::int64_t sure = 0, possible = 0;
      for (std::size_t n = 0; n < run.impacts->time.size(); ++n) {
        if (run.impacts->damper[n] != std::int32_t(damper)) continue;
        sure += run.impacts->time[n] < crossing - near;
        possible += run.impacts->time[n] <= crossing + near;
      }
      if (before[damper] < sure || before[damper] > possible)
        judge.differ("damper " + std::to_string(damper) + ": impacts up to row " + std::to_string(row) +
                     " are " + std::to_string(before[damper]) + ", true " + std::to_string(sure));
    }
    if (all != rows.impacts[row])
      judge.differ("impacts of row " + std::to_string(row) + " are not the sum of the dampers'");
  }
}

// The half cycle of each impact, unless the impact coincides with a crossing.
void judge_half_cycles(const Run& run, const Answer& answer, const Walk& both, const Units& units,
                       const Negligible& below, const Judge& judge) {
  const auto &mine = both.my_rows, &its = both.its_rows;
  std::vector<Quad> crossings;
  for (const Row& each : mine) crossings.push_back(each.zero_crossing);
  for (std::size_t n = 0; n < both.impacts.size(); ++n) {
    const auto [i, j] = both.impacts[n];
    const Impact& p = answer.impacts[i];
    const Quad near = below.duration(p.time);
    const std::size_t row = std::lower_bound(crossings.begin(), crossings.end(), p.time) - crossings.begin();
    const bool coincides = (row < crossings.size() && crossings[row] - p.time <= near) ||
                           (row > 0 && p.time - crossings[row - 1] <= near);
    // Of a row that was three phases and amplitudes are those of one of them.
    const bool was_three = row < mine.size() && (mine[row].merged || its[row].merged);
    if (coincides || was_three || both.rough[n]) continue;
    if (row == crossings.size()) {
      if (run.impacts->phase_deg[j] || run.impacts->amplitude[j])
        judge.differ("impact" + row_index(j) + " has a phase or an amplitude in an unfinished half cycle");
      continue;
    }
    if (run.impacts->amplitude[j])
      judge.number("impact's amplitude" + row_index(j), *run.impacts->amplitude[j], mine[row].amplitude,
                   units.predicted(x_, crossings[row]));
    else
      judge.differ("impact" + row_index(j) + " has no amplitude");
    if (bool(run.impacts->phase_deg[j]) != (row > 0)) {
      judge.differ("impact" + row_index(j) + ": phase there or not");
    } else if (row > 0) {
      const Quad length = crossings[row] - crossings[row - 1];
      const auto crossed = [&](std::size_t at) {
        return units.met(crossings[at], units.motion(crossings[at]), mine[at].speed);
      };
      judge.number(
          "phase" + row_index(j), *run.impacts->phase_deg[j], 180 * (p.time - crossings[row - 1]) / length,
          360 / length *
              (units.met(p.time, units.place(), p.relative_velocity) + crossed(row) + crossed(row - 1)));
    }
  }
}

// Where two peaks of a row have one height, or the release and the turn right after it, either will do: |x|
// is as large there.
void judge_other_peaks(const Walk& both, Question question, const Units& units, const Negligible& below,
                       const Judge& judge) {
  std::vector<std::size_t> rows;
  Quad last_crossing = 0;
  question.samples.clear();
  for (std::size_t n = 0; n < std::min(both.my_rows.size(), both.its_rows.size()); ++n) {
    const Row &p = both.my_rows[n], &q = both.its_rows[n];
    if (both.mismatch && p.zero_crossing >= *both.mismatch) break;
    const Quad crossing = std::exchange(last_crossing, p.zero_crossing);
    if (same_peak(p, q) && (n > 0 || q.peak_time != 0)) continue;
    if (q.peak_time < crossing - below.duration(crossing) || q.peak_time > p.zero_crossing) {
      judge.number("peak time" + row_index(n), double(q.peak_time), p.peak_time,
                   units.predicted(peak_time_, p.zero_crossing) + units.predicted(time_, p.zero_crossing));
      continue;
    }
    rows.push_back(n);
    question.samples.push_back(double(q.peak_time));
  }
  if (rows.empty()) return;
  const Answer answer = answer_to(question);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Row& p = both.my_rows[rows[i]];
    judge.number("|x| at peak time" + row_index(rows[i]), double(p.amplitude),
                 magnitude(answer.samples.at(i).x), units.predicted(x_, p.zero_crossing));
  }
}

void judge_samples(const Run& run, const Prediction& prediction, const Units& units, const Negligible& below,
                   const Setting& setting, const Judge& judge) {
  const History& history = *run.history;
  if (history.time != sample_times(*run.scene.until_time))
    return judge.differ("other samples than were asked for");
  for (std::size_t i = 0; i < history.time.size(); ++i) {
    const Quad t = history.time[i];
    const Sample& truth = prediction.answer.samples.at(i);
    const std::array<Quad, 4>& grown = prediction.samples[i];
    const std::string where = " at " + text(t, 17);
    // An impact within rounding of a sample: before or after it?
    const Quad near = std::max(below.duration(t), setting.nested ? Quad(sticking_begin) * (1 + t) : Quad(0));
    bool coincides = false;
    for (const Impact& each : prediction.answer.impacts)
      coincides = coincides || magnitude(each.time - t) <= near;
    judge.number("x" + where, history.x[i], truth.x, grown[0] + units.predicted(x_, t));
    if (!coincides) judge.number("v" + where, history.v[i], truth.v, grown[1] + units.predicted(v_, t));
    for (std::size_t n = 0; n < truth.y.size(); ++n) {
      judge.number("y" + where, history.dampers[n].y.at(i), truth.y[n], grown[2] + units.predicted(y_, t));
      if (!coincides)
        judge.number("w" + where, history.dampers[n].w.at(i), truth.w[n], grown[3] + units.predicted(w_, t));
    }
  }
}

// (gamma sum of nu)^2: twice the energy by which weight draws the masses down.
Quad square_of_pull(const Scene& scene) {
  Quad mass = 0;
  for (const SceneDamper& each : scene.dampers) mass += each.mass_ratio;
  return mass * mass * scene.weight * scene.weight;
}
// Each term of the energy balance may be off by roundings of the largest.
void judge_energy(const Run& run, const Prediction& prediction, const Walk& both, const Setting& setting,
                  const Judge& judge) {
  const EnergyBalance& balance = *run.energy;
  const Answer& answer = prediction.answer;
  const Quad rounding = setting.accuracy.rounding;
  const Quad floor = rounding * (answer.initial.total() + answer.turnover + answer.viscous_work);
  const std::vector<Term> mine = terms_of(answer, setting), its = terms_of(balance, setting);
  for (std::size_t i = 0; i < its.size(); ++i) {
    Quad unit = mine[i].initial ? Quad(0) : prediction.terms[i] + floor;
    // omega_f t is rounded, too, which no noise of the state stands for: the force is off by as many
    // roundings as it has radians.
    if (mine[i].name == "forcing work")
      unit += rounding * answer.turnover * run.scene.force_frequency * *run.scene.until_time;
    judge.number(mine[i].name, double(its[i].value), mine[i].value, unit);
  }
  // Divided by the energy that is available (18.5), which where weight draws the masses down is the rest of
  // larger terms.
  const Quad available = answer.initial.total() + square_of_pull(setting.scene()) / 2 + answer.turnover;
  const Quad largest = std::max(answer.initial.spring, answer.final.spring) +
                       std::max(magnitude(answer.initial.weight), magnitude(answer.final.weight));
  judge.number("residual", balance.residual, 0,
               rounding * (10 + (largest > available ? largest / available : Quad(0))));
  if (setting.question.walls != Walls::rigid || both.mismatch || setting.nested) return;
  Quad jumped = answer.sum(&DamperEnergy::chatter_loss), grown = floor;
  for (const std::size_t i : both.skipped) jumped += answer.impacts[i].loss;
  for (std::size_t i = 0; i < mine.size(); ++i)
    if (mine[i].name == "loss of all impacts") grown += prediction.terms[i];
  // Each complete chattering is one jump, but for those in which all is negligible; a plastic impact is none.
  std::int64_t complete = 0;
  const auto& impacts = answer.impacts;
  for (std::size_t i = 0; i < impacts.size(); ++i)
    complete += impacts[i].accumulation &&
                (i + 1 == impacts.size() || impacts[i + 1].accumulation != impacts[i].accumulation);
  if (balance.bounce_downs < both.jumps || balance.bounce_downs > complete)
    judge.differ("bounce-downs: " + std::to_string(balance.bounce_downs) + ", true " +
                 std::to_string(both.jumps));
  judge.number("bounce-down loss", balance.bounce_down_loss, jumped, grown);
}

// Judges everything in `run`.
void judge_run(const Run& run, const Setting& setting, const Prediction& prediction, const Judge& judge,
               Comparison& result) {
  const Scene& scene = run.scene;
  const std::size_t count = scene.dampers.size(), with_energy = run.energy->dampers.size();
  if (run.history->dampers.size() != count || (with_energy != count && (count > 1 || with_energy > 0)))
    return judge.differ("energies or history of another number of dampers");
  judge.number("end time", run.end_time, *scene.until_time, 0);
  if (run.stop_reason != StopReason::time)
    judge.differ("stopped by " + std::string(name_of(run.stop_reason)));
  const Answer &answer = prediction.answer, recorded = answer_of(run);
  const Units units(setting, prediction, run);
  const Negligible below = units.negligible();
  const Walk both = Walker(answer, recorded, setting, below).walk();
  if (both.mismatch) judge.differ(both.what);
  result.impacts += std::int64_t(both.impacts.size());
  numbers_of_events(answer, recorded, both, setting, [&](const Number& each) {
    judge.number(each.what, double(each.its), each.mine, each.unit(units));
  });
  if (!both.mismatch) {
    judge_half_cycles(run, answer, both, units, below, judge);
    judge_counts(run, below, judge);
  }
  judge_other_peaks(both, setting.question, units, below, judge);
  judge_order(run, answer, setting.question.walls, judge);
  judge_samples(run, prediction, units, below, setting, judge);
  judge_energy(run, prediction, both, setting, judge);
}

// The longest part of the scene that can be predicted; shortens it to that.
Prediction predict_what_can_be(Setting& setting, Comparison& result) {
  std::optional<double>& until = setting.question.scene.until_time;
  result.asked = *until;
  Prediction prediction = predict(setting);
  for (int i = 0; i < 4 && prediction.ends; ++i) {
    result.ended_by = prediction.why;
    // Half a sample earlier: what ends it, and its noise, stay outside.
    const double end = double(*prediction.ends) - *until / sample_count / 2;
    if (!(end > 0)) return prediction;
    until = end;
    prediction = predict(setting);
  }
  if (!prediction.ends) result.until = *until;
  return prediction;
}

Record everything(double end) {
  Record record{.impacts = true, .contacts = true, .energy = true, .history = {{0, end, sample_count}}};
  return record;
}
Run simulated(const Scene& scene, const Engine& engine, const Record& record, bool as_list) {
  if (!as_list || !has_one_damper(scene)) return simulate(scene, engine, record);
  Run run = in_its_own_units(simulate(list_of_one(scene), engine, record));
  run.scene = scene;
  return run;
}

// With a quarter of the step every error is to be a sixteenth, once steps are short enough for the scene:
// they are shortened twice where that is not so. A column's largest error stands for it.
void compare_by_order(const Setting& setting, const Prediction& prediction, Cem engine, Comparison& result) {
  const Scene& scene = setting.scene();
  for (const double finer : finer_steps) {
    // By what the step is divided by, and by column: the error itself, and in units of the predicted one.
    std::map<int, std::map<std::string, std::array<double, 2>>> errors;
    result.differences.clear();
    result.numbers = result.impacts = 0;
    result.worst = 0;
    for (const int by : {1, 4}) {
      engine.time_step = first_step(scene) / finer / by;
      const Run run = simulate(scene, engine, everything(*scene.until_time));
      Judge judge;
      judge.number = [&](const std::string& what, double value, Quad truth, Quad predicted) {
        ++result.numbers;
        auto& [most, by_unit] = errors[by][what.substr(0, std::min(what.find('['), what.find(" at ")))];
        const Quad error = magnitude(value - truth);
        const Quad unit = predicted + Quad(central_differences.rounding) * magnitude(truth) + Quad(1e-300L);
        most = std::max(most, double(error));
        by_unit = std::max(by_unit, double(error / unit));
      };
      judge.differ = [&](const std::string& what) { result.differences.push_back(what); };
      judge_run(run, setting, prediction, judge, result);
    }
    for (const auto& [column, at_full] : errors[1]) {
      const auto& at_quarter = errors[4][column];
      if (at_full[1] > result.worst) result.worst = at_full[1], result.worst_what = column;
      // Half at least: where in a step a sample lies changes its error, and of two kinks near a sample one
      // may be before it now and behind it then. What is far below the method's error has leading terms that
      // cancel, and need not shrink.
      if (at_quarter[0] <= at_full[0] / 2 || at_quarter[1] <= 1e-2) continue;
      // In flight cem counts y from the left wall: at the right one a step moves it by no less than rounding
      // of 1, so that velocities are multiples of about epsilon / h.
      const double step = first_step(scene) / finer / 4;
      if (at_quarter[0] <= 4 * std::numeric_limits<double>::epsilon() / step) continue;
      result.differences.push_back(column + " is off by " + text(at_full[0], 3) +
                                   ", with a quarter of the step by " + text(at_quarter[0], 3) + ": " +
                                   text(at_quarter[1], 3) + " of what is predicted");
    }
    if (result.differences.empty()) return;
  }
}

// That the run ends where it is told to: by an amplitude, a number of half cycles, a number of impacts. Asked
// in the middle, where nothing coincides.
void compare_stops(const Setting& setting, Engine engine, bool as_list, const Prediction& prediction,
                   const Judge& judge) {
  const Answer& answer = prediction.answer;
  const auto time = [&](const std::string& what, const Run& run, StopReason reason, Quad truth) {
    if (run.stop_reason != reason)
      judge.differ("stop at " + what + ": by " + std::string(name_of(run.stop_reason)) + " at " +
                   text(run.end_time, 17) + ", true " + text(truth, 20));
    else
      judge.number("stop at " + what, run.end_time, truth,
                   prediction.growth(time_, truth) + Quad(0x1p-53) * 100 * (1 + truth));
  };
  const auto& rows = answer.half_cycles;
  const std::size_t row = rows.size() / 2;
  // Where x only touches zero rounding decides whether there is a row.
  const bool tall = std::all_of(rows.begin(), rows.end(),
                                [](const HalfCycle& each) { return each.amplitude > Quad(1e-6L); });
  const auto spread = [&](Quad amplitude) {
    return std::all_of(rows.begin(), rows.end(), [&](const HalfCycle& each) {
      return magnitude(each.amplitude - amplitude) > Quad(1e-6L) * amplitude;
    });
  };
  if (tall && row + 1 < rows.size()) {
    const double amplitude = double(rows[row].amplitude) * 1.001;
    const auto first = std::find_if(rows.begin(), rows.end(),
                                    [&](const HalfCycle& each) { return each.amplitude < Quad(amplitude); });
    if (spread(amplitude)) {
      Scene stopped = setting.scene();
      stopped.until_amplitude = amplitude;
      time("amplitude " + text(amplitude, 17), simulated(stopped, engine, {}, as_list), StopReason::amplitude,
           first->zero_crossing);
    }
  }
  const auto budget = [&]() -> Budget& {
    return std::visit([](auto& each) -> Budget& { return each.budget; }, engine);
  };
  const Budget before = budget();
  if (tall && row + 1 < rows.size()) {
    budget().max_half_cycles = std::int64_t(row) + 1;
    time("half cycle " + std::to_string(row), simulated(setting.scene(), engine, {}, as_list),
         StopReason::half_cycle_budget, rows[row].zero_crossing);
    budget() = before;
  }
  // The run ends with the impact that would be one too many.
  const auto& impacts = answer.impacts;
  const std::size_t most = impacts.size() / 2;
  const auto plain = [](const Impact& each) {
    return each.impulse && !each.accumulation && magnitude(each.relative_velocity) > Quad(1e-6L);
  };
  if (most < impacts.size() &&
      std::all_of(impacts.begin(), impacts.begin() + std::ptrdiff_t(most) + 1, plain)) {
    budget().max_impacts = std::int64_t(most);
    time("impact " + std::to_string(most), simulated(setting.scene(), engine, {}, as_list),
         StopReason::impact_budget, impacts[most].time);
  }
}

Setting setting_of(const Scene& scene, const Engine& engine, const Comparing& how) {
  Setting setting{{}, std::holds_alternative<Cem>(engine) ? central_differences : closed_forms};
  Question& question = setting.question;
  question.scene = scene;
  question.walls = std::holds_alternative<Restitution>(engine) ? Walls::rigid : Walls::compliant;
  if (const Exact* const exact = std::get_if<Exact>(&engine)) question.calibration = exact->calibration;
  if (has_components(scene)) question.most_steps = 2'000;  // at rest on a wall, which pushes
  if (how.as_list || scene.dampers.size() > 1) {
    question.most_impacts = 8000;
    question.most_steps = question.walls == Walls::rigid ? 32'000 : 5'000;
    if (!setting.accuracy.by_steps) setting.accuracy.predictable = 1e-10;
  }
  if (how.most_steps > 0) question.most_steps = how.most_steps;
  setting.nested = question.walls == Walls::rigid && scene.dampers.size() > 1;
  return setting;
}

// The run of the program or, if there is none, of the engine.
void compare_with(const Setting& setting, const Prediction& prediction, const Engine& engine,
                  const Comparing& how, const Program& program, Comparison& result) {
  const Answer& answer = prediction.answer;
  for (std::size_t i = 0; i + 1 < answer.impacts.size(); ++i)
    result.joint_impacts += answer.impacts[i].time == answer.impacts[i + 1].time;
  for (std::size_t i = 0; i + 1 < answer.contacts.size(); ++i)
    result.joint_contacts += answer.contacts[i].begin < answer.contacts[i + 1].end &&
                             answer.contacts[i + 1].begin < answer.contacts[i].end;
  Judge judge;
  judge.differ = [&](const std::string& what) { result.differences.push_back(what); };
  // `predicted`: by growth. A value that was rounded once is off by that, too.
  judge.number = [&](const std::string& what, double value, Quad truth, Quad predicted) {
    ++result.numbers;
    const Quad error = magnitude(Quad(value) - truth);
    const Quad unit = predicted + Quad(setting.accuracy.rounding) * magnitude(truth) + Quad(1e-300L);
    const double ratio = double(error / unit);
    if (!(ratio <= result.worst)) result.worst = ratio, result.worst_what = what;
    if (!(ratio <= how.allowed))
      judge.differ(what + " is " + text(value, 17) + ", true " + text(truth, 20) + ", off by " +
                   text(error, 3) + ", predicted " + text(unit, 3));
  };
  try {
    if (const Cem* const cem = std::get_if<Cem>(&engine)) {
      compare_by_order(setting, prediction, *cem, result);
    } else {
      const Scene& scene = setting.scene();
      judge_run(program ? program(scene) : oracle::simulated(scene, engine, how.as_list), setting, prediction,
                judge, result);
      if (!program) compare_stops(setting, engine, how.as_list, prediction, judge);
    }
  } catch (const std::exception& error) {
    judge.differ(std::string("throws: ") + error.what());
  }
}

}  // namespace

Run simulated(const Scene& scene, const Engine& engine, bool as_list) {
  return simulated(scene, engine, everything(*scene.until_time), as_list);
}

std::vector<Comparison> compare(const Scene& asked, const Engine& engine, const Comparing& how,
                                const std::vector<Program>& programs) {
  Comparison result;
  Setting setting = setting_of(asked, engine, how);
  const Prediction prediction = predict_what_can_be(setting, result);
  std::vector<Comparison> all(programs.size(), result);
  if (result.until == 0) return all;
  for (std::size_t i = 0; i < programs.size(); ++i)
    compare_with(setting, prediction, engine, how, programs[i], all[i]);
  return all;
}
Comparison compare(const Scene& scene, const Engine& engine, const Comparing& how) {
  return compare(scene, engine, how, {Program()}).front();
}

Run run_of_oracle(const Scene& scene, Walls walls, Fault fault, int samples) {
  Question question;
  question.scene = scene;
  question.scene.until_amplitude.reset();
  question.fault = fault;
  question.walls = walls;
  question.most_impacts = 8'000, question.most_steps = 32'000;
  question.samples = sample_times(*scene.until_time, samples);
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
  energy.dampers.resize(count);
  for (std::size_t n = 0; n < count; ++n) {
    const DamperEnergy& its = answer.dampers[n];
    energy.dampers[n] = {double(its.initial),
                         double(its.final),
                         0,
                         double(its.contact_loss),
                         0,
                         double(its.chatter_loss),
                         double(its.friction_loss),
                         double(its.drag_loss)};
  }
  HalfCycles& rows = *run.half_cycles;
  rows.dampers.resize(count);
  for (const HalfCycle& each : answer.half_cycles) {
    rows.zero_crossing.push_back(double(each.zero_crossing));
    rows.peak_time.push_back(double(each.peak_time));
    rows.amplitude.push_back(double(each.amplitude));
  }
  rows.impacts.resize(rows.amplitude.size());
  for (HalfCycles::Damper& its : rows.dampers) its.impacts.resize(rows.amplitude.size());
  for (const Impact& each : answer.impacts) {
    run.impacts->time.push_back(double(each.time));
    run.impacts->wall.push_back(each.wall);
    run.impacts->damper.push_back(each.damper);
    run.impacts->relative_velocity.push_back(double(each.relative_velocity));
    run.impacts->displacement.push_back(double(each.displacement));
    energy.impact_loss.push_back(double(each.loss));
    energy.dampers[each.damper].impact_loss += double(each.loss);
    const auto row = std::size_t(
        std::lower_bound(answer.half_cycles.begin(), answer.half_cycles.end(), each.time,
                         [](const HalfCycle& half_cycle, Quad t) { return half_cycle.zero_crossing < t; }) -
        answer.half_cycles.begin());
    auto& amplitude = run.impacts->amplitude.emplace_back();
    auto& phase = run.impacts->phase_deg.emplace_back();
    if (row == rows.amplitude.size()) continue;
    ++rows.impacts[row], ++rows.dampers[each.damper].impacts[row];
    amplitude = rows.amplitude[row];
    if (row == 0) continue;
    const Quad begin = answer.half_cycles[row - 1].zero_crossing;
    phase = double(180 * (each.time - begin) / (answer.half_cycles[row].zero_crossing - begin));
  }
  for (const Contact& each : answer.contacts) {
    run.contacts->begin.push_back(double(each.begin));
    run.contacts->end.push_back(double(each.end));
    run.contacts->damper.push_back(each.damper);
    run.contacts->wall.push_back(each.wall);
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
  const auto rounded = [](const Energy& now) {
    return impact_damper::Energy{double(now.kinetic), double(now.spring), double(now.wall), double(now.paper),
                                 double(now.weight)};
  };
  energy.initial = rounded(answer.initial), energy.final = rounded(answer.final);
  energy.contact_loss = double(answer.sum(&DamperEnergy::contact_loss));
  energy.bounce_down_loss = double(answer.sum(&DamperEnergy::chatter_loss));
  energy.friction_loss = double(answer.sum(&DamperEnergy::friction_loss));
  energy.drag_loss = double(answer.sum(&DamperEnergy::drag_loss));
  energy.viscous_work = double(answer.viscous_work), energy.forcing_work = double(answer.forcing_work);
  return run;
}

}  // namespace oracle
