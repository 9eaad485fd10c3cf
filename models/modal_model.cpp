#include "models/modal_model.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <numeric>
#include <set>

namespace whirl::models {
namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

// What a free parameter stands for.
struct Slot {
  enum class Of { omega, frequency, stiffness, damping, damping_ratio, coefficient, amplitude };
  Of of;
  int index = 0;  // of the entry; row * n + column of a stiffness
};

struct Entry {
  std::string name, group;  // group: a further name that several entries share
  Slot slot;
  double value;
  std::string unit;
};

// Every number of the model in a fixed order.
std::vector<Entry> entries(const ModalModel& m) {
  using Of = Slot::Of;
  std::vector<Entry> all{{"omega", "", {Of::omega}, m.omega, "rad/s"}};
  const auto list = [&](const char* name, const std::vector<double>& values, Of of, const char* unit) {
    for (std::size_t i = 0; i < values.size(); ++i)
      all.push_back({fmt::format("{}[{}]", name, i + 1), name, {of, static_cast<int>(i)}, values[i], unit});
  };
  list("frequency", m.frequency, Of::frequency, "rad/s");
  for (std::size_t i = 0; i < m.stiffness.size(); ++i)
    for (std::size_t j = 0; j < m.stiffness[i].size(); ++j)
      all.push_back({fmt::format("stiffness[{}][{}]", i + 1, j + 1),
                     "",
                     {Of::stiffness, m.size() * static_cast<int>(i) + static_cast<int>(j)},
                     m.stiffness[i][j],
                     "1/s^2"});
  list("damping", m.damping, Of::damping, "1/s");
  list("damping_ratio", m.damping_ratio, Of::damping_ratio, "-");
  for (std::size_t i = 0; i < m.terms.size(); ++i)
    all.push_back({fmt::format("term[{}].coefficient", i + 1), m.terms[i].name, {Of::coefficient, static_cast<int>(i)}, m.terms[i].coefficient, "-"});
  for (std::size_t i = 0; i < m.forces.size(); ++i)
    all.push_back(
        {fmt::format("force[{}].amplitude", i + 1), m.forces[i].name, {Of::amplitude, static_cast<int>(i)}, m.forces[i].amplitude, "m/s^2"});
  return all;
}

// The entries that a name moves.
std::vector<Entry> chosen(const ModalModel& m, const std::string& name) {
  const std::string prefix = "modal_model.", bare = name.starts_with(prefix) ? name.substr(prefix.size()) : name;
  std::vector<Entry> found;
  for (auto& e : entries(m))
    if (e.name == bare || (!e.group.empty() && e.group == bare)) found.push_back(std::move(e));
  if (found.empty()) throw std::invalid_argument(fmt::format("no parameter '{}'; accepted: {}", name, fmt::join(m.lens_names(), ", ")));
  for (const auto& e : found)
    if (e.value != found.front().value)
      throw std::invalid_argument(fmt::format("'{}' stands for numbers that differ: choose one, such as {}", name, found.front().name));
  return found;
}

class ModalMaker {
 public:
  ModalMaker(const ModalModel& m, const std::vector<std::string>& lenses) : m_(m), n_(m.size()) {
    std::set<std::pair<Slot::Of, int>> taken;
    for (const auto& name : lenses) {
      slots_.emplace_back();
      for (const auto& e : chosen(m, name)) {
        if (!taken.insert({e.slot.of, e.slot.index}).second) throw std::invalid_argument(fmt::format("{} is free twice", e.name));
        slots_.back().push_back(e.slot);
      }
    }
    for (int i = 0; i < n_ && m.frequency.empty(); ++i)
      for (int j = 0; j < n_; ++j)
        if (i != j && (m.stiffness[at(i)][at(j)] != 0.0 || taken.contains({Slot::Of::stiffness, i * n_ + j}))) coupling_.push_back(i * n_ + j);
  }

  template <class S>
  void operator()(std::span<const S> p, ModalSystem<S>& out) const {
    const auto moved = [&](Slot::Of of, int index, double otherwise) {
      for (std::size_t k = 0; k < slots_.size(); ++k)
        for (const Slot& s : slots_[k])
          if (s.of == of && s.index == index) return S(p[k]);
      return S(otherwise);
    };
    out.omega = moved(Slot::Of::omega, 0, m_.omega);
    out.damping.resize(at(n_));
    out.stiffness.resize(at(n_));
    for (int i = 0; i < n_; ++i) {
      S frequency(0.0);
      if (!m_.frequency.empty()) {
        frequency = moved(Slot::Of::frequency, i, m_.frequency[at(i)]);
        out.stiffness[at(i)] = frequency * frequency;
      } else {
        out.stiffness[at(i)] = moved(Slot::Of::stiffness, i * n_ + i, m_.stiffness[at(i)][at(i)]);
      }
      if (!m_.damping.empty()) out.damping[at(i)] = moved(Slot::Of::damping, i, m_.damping[at(i)]);
      else if (!m_.damping_ratio.empty()) out.damping[at(i)] = moved(Slot::Of::damping_ratio, i, m_.damping_ratio[at(i)]) * frequency * 2.0;
      else out.damping[at(i)] = S(0.0);
    }
    const std::size_t count = m_.terms.size();
    out.terms.resize(count + coupling_.size());
    out.forces.resize(m_.forces.size());
    out.max_harmonic = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const auto& t = m_.terms[i];
      Term<S>& to = out.terms[i];
      to = {t.equation, moved(Slot::Of::coefficient, static_cast<int>(i), t.coefficient), 0, {}, t.cos_harmonic};
      for (int c = 0; c < n_; ++c)
        for (int k = 0; k < t.powers[at(c)]; ++k) to.factor[at(to.degree++)] = static_cast<short>(c);
      out.max_harmonic = std::max(out.max_harmonic, t.cos_harmonic);
    }
    for (std::size_t i = 0; i < coupling_.size(); ++i) {
      const int row = coupling_[i] / n_, column = coupling_[i] % n_;
      out.terms[count + i] = {row, moved(Slot::Of::stiffness, coupling_[i], m_.stiffness[at(row)][at(column)]), 1, {static_cast<short>(column)}, 0};
    }
    for (std::size_t i = 0; i < m_.forces.size(); ++i) {
      const auto& f = m_.forces[i];
      out.forces[i] = {f.equation, moved(Slot::Of::amplitude, static_cast<int>(i), f.amplitude), f.harmonic};
      out.max_harmonic = std::max(out.max_harmonic, f.harmonic);
    }
  }

 private:
  ModalModel m_;
  int n_;
  std::vector<std::vector<Slot>> slots_;  // of each free parameter
  std::vector<int> coupling_;             // off-diagonal stiffnesses that are not always zero
};

void check(bool ok, const std::string& what) {
  if (!ok) throw std::invalid_argument(what);
}

void check_list(const char* name, const std::vector<double>& values, int n, bool positive) {
  check(values.empty() || static_cast<int>(values.size()) == n, fmt::format("{} has {} values for {} coordinates", name, values.size(), n));
  for (const double x : values)
    check(std::isfinite(x) && (!positive || x > 0.0), fmt::format("{} must be {}, got {}", name, positive ? "> 0" : "finite", x));
}

}  // namespace

void ModalModel::validate() const {
  const int n = size();
  check(frequency.empty() != stiffness.empty(), "give either frequency or stiffness");
  check(damping.empty() || damping_ratio.empty(), "give either damping or damping_ratio");
  check(damping_ratio.empty() || !frequency.empty(), "damping_ratio needs frequency");
  check(std::isfinite(omega) && omega > 0.0, fmt::format("omega must be > 0, got {}", omega));
  check_list("frequency", frequency, n, true);
  check_list("damping", damping, n, false);
  check_list("damping_ratio", damping_ratio, n, false);
  for (const auto& row : stiffness) check_list("each row of stiffness", row, n, false);
  for (const auto& row : stiffness) check(!row.empty(), "each row of stiffness needs a value for each coordinate");
  for (std::size_t i = 0; i < terms.size(); ++i) {
    const auto& t = terms[i];
    const std::string who = fmt::format("term[{}]", i + 1);
    check(t.equation >= 0 && t.equation < n, fmt::format("{}: equation must be in 1..{}, got {}", who, n, t.equation + 1));
    check(static_cast<int>(t.powers.size()) == n, fmt::format("{}: {} powers for {} coordinates", who, t.powers.size(), n));
    check(std::all_of(t.powers.begin(), t.powers.end(), [](int k) { return k >= 0; }), fmt::format("{}: powers must be >= 0", who));
    const int degree = std::accumulate(t.powers.begin(), t.powers.end(), 0);
    check(degree <= models::Term<double>::max_degree, fmt::format("{}: powers sum to {}, at most {}", who, degree, models::Term<double>::max_degree));
    check(t.cos_harmonic >= 0, fmt::format("{}: cos_harmonic must be >= 0, got {}", who, t.cos_harmonic));
    check(std::isfinite(t.coefficient), fmt::format("{}: coefficient must be finite", who));
  }
  for (std::size_t i = 0; i < forces.size(); ++i) {
    const auto& f = forces[i];
    const std::string who = fmt::format("force[{}]", i + 1);
    check(f.equation >= 0 && f.equation < n, fmt::format("{}: equation must be in 1..{}, got {}", who, n, f.equation + 1));
    check(f.harmonic >= 0, fmt::format("{}: harmonic must be >= 0, got {}", who, f.harmonic));
    check(std::isfinite(f.amplitude), fmt::format("{}: amplitude must be finite", who));
  }
}

std::vector<std::string> ModalModel::lens_names() const {
  std::vector<std::string> names;
  std::vector<Entry> all = entries(*this);
  for (const auto& e : all) names.push_back(e.name);
  for (const auto& e : all) {  // groups of equal numbers
    const bool equal = std::all_of(all.begin(), all.end(), [&](const Entry& o) { return o.group != e.group || o.value == e.value; });
    if (!e.group.empty() && equal && std::find(names.begin(), names.end(), e.group) == names.end()) names.push_back(e.group);
  }
  return names;
}

double ModalModel::lens_value(const std::string& name) const { return chosen(*this, name).front().value; }
std::string ModalModel::lens_unit(const std::string& name) const { return chosen(*this, name).front().unit; }

ParametricSystem modal_system(const ModalModel& model, const std::vector<std::string>& lenses) {
  model.validate();
  Vector reference(static_cast<Eigen::Index>(lenses.size()));
  for (std::size_t i = 0; i < lenses.size(); ++i) reference[static_cast<Eigen::Index>(i)] = model.lens_value(lenses[i]);
  return ParametricSystem(ModalMaker(model, lenses), lenses, reference);
}

ModalSystem<double> modal_system(const ModalModel& model) {
  model.validate();
  ModalSystem<double> out;
  ModalMaker(model, {})(std::span<const double>{}, out);
  return out;
}

std::vector<CoordinateReflection> mirrors(const ModalModel& model, const std::vector<std::string>& lenses) {
  model.validate();
  const int n = model.size();
  std::set<std::pair<Slot::Of, int>> free;
  for (const auto& name : lenses)
    for (const auto& e : chosen(model, name)) free.insert({e.slot.of, e.slot.index});
  // One condition a row: the signs of the coordinates marked must multiply to +1.
  std::vector<std::vector<bool>> rows;
  const auto condition = [&] { return std::vector<bool>(at(n), false); };
  for (std::size_t i = 0; i < model.terms.size(); ++i) {
    const auto& t = model.terms[i];
    if (t.coefficient == 0.0 && !free.contains({Slot::Of::coefficient, static_cast<int>(i)})) continue;
    auto row = condition();
    row[at(t.equation)] = true;
    for (int c = 0; c < n; ++c)
      if (t.powers[at(c)] % 2 != 0) row[at(c)] = !row[at(c)];
    rows.push_back(row);
  }
  for (int i = 0; i < n && model.frequency.empty(); ++i)
    for (int j = 0; j < n; ++j) {
      if (i == j || (model.stiffness[at(i)][at(j)] == 0.0 && !free.contains({Slot::Of::stiffness, i * n + j}))) continue;
      auto row = condition();
      row[at(i)] = row[at(j)] = true;
      rows.push_back(row);
    }
  for (std::size_t i = 0; i < model.forces.size(); ++i) {
    if (model.forces[i].amplitude == 0.0 && !free.contains({Slot::Of::amplitude, static_cast<int>(i)})) continue;
    auto row = condition();
    row[at(model.forces[i].equation)] = true;
    rows.push_back(row);
  }
  // Reduced echelon form; each column without a pivot gives a generator.
  std::vector<int> pivot_of_column(at(n), -1);
  std::size_t rank = 0;
  for (int c = n - 1; c >= 0; --c) {  // later coordinates depend on earlier ones: generators flip as few of the first as possible
    const auto it = std::find_if(rows.begin() + static_cast<std::ptrdiff_t>(rank), rows.end(), [&](const auto& r) { return r[at(c)]; });
    if (it == rows.end()) continue;
    std::swap(*it, rows[rank]);
    for (std::size_t r = 0; r < rows.size(); ++r)
      if (r != rank && rows[r][at(c)])
        for (int k = 0; k < n; ++k) rows[r][at(k)] = rows[r][at(k)] != rows[rank][at(k)];
    pivot_of_column[at(c)] = static_cast<int>(rank++);
  }
  std::vector<CoordinateReflection> found;
  for (int c = 0; c < n; ++c) {
    if (pivot_of_column[at(c)] >= 0) continue;
    CoordinateReflection r{std::vector<int>(at(n), 1), model.mirror_subtype};
    r.signs[at(c)] = -1;
    for (int k = 0; k < n; ++k)
      if (pivot_of_column[at(k)] >= 0 && rows[at(pivot_of_column[at(k)])][at(c)]) r.signs[at(k)] = -1;
    found.push_back(r);
  }
  return found;
}

}  // namespace whirl::models
