// The Oresund slow flow, n = 2, U = 0.5 m, walked by Whirl and by AUTO-07p in turn. Called by `run`.
//
//     against coefficients                   the model in Fortran, 17 digits
//     against walk                           Whirl's two branches once: what a whole process costs
//     against compare AUTO WORK REPETITIONS  tables; WORK holds a directory with fort.2 (and fort.3) for each run of the program AUTO
//     against orbits AUTO WORK REPETITIONS   the same for exact periodic motions: in-plane branch, multipliers and events on both sides
#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

#include "continuation/walker.hpp"
#include "models/closed_forms.hpp"
#include "models/harmonic_balance.hpp"
#include "models/superharmonic.hpp"

using namespace whirl;
using namespace whirl::models;
using namespace whirl::continuation;

namespace {

double cpu_microseconds() {  // of this process: other programs' load does not count
  timespec t;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return 1e6 * static_cast<double>(t.tv_sec) + 1e-3 * static_cast<double>(t.tv_nsec);
}
double median(std::vector<double> v) {
  std::sort(v.begin(), v.end());
  return v.size() % 2 ? v[v.size() / 2] : 0.5 * (v[v.size() / 2 - 1] + v[v.size() / 2]);
}

const StayParameters<double> stay{{260.0, 2.17e9, 5.5e6, 81.05, 30.4, 9.81}, 0.01, 0.01, 0.5, 1.8};
constexpr double lower = 1.2, upper = 2.4;

struct Special {
  std::string type;
  double omega;
};
struct Curve {
  int points = 0;
  std::vector<Special> special;
};

class Whirl {
 public:
  explicit Whirl(bool short_steps) {
    options_.lower = lower;
    options_.upper = upper;
    if (short_steps) options_.max_step /= 10.0;
    start_ << in_plane_states(flow_.model().coefficients<double>(std::array<double, 1>{lower})).front(), lower;
    planar_ = Walker(flow_, options_).walk(start_);
    const auto first = std::find_if(planar_.special.begin(), planar_.special.end(), [](const auto& s) { return s.type == EventType::branch_point; });
    if (first == planar_.special.end()) throw std::runtime_error("no branch point on the in-plane branch");
    onset_ = first->u;
    direction_.head(4) = first->null_vector;
  }
  Branch in_plane() const { return Walker(flow_, options_).walk(start_); }
  Branch whirling() const { return Walker(flow_, options_).walk_from(onset_, direction_, true); }
  const Vector& start() const { return start_; }

 private:
  SuperharmonicFlow flow_{stay, {.order = 2}, {Lens("omega")}};
  WalkOptions options_;
  Vector start_ = Vector::Zero(5), direction_ = Vector::Zero(5), onset_;
  Branch planar_;
};

void print_coefficients() {
  const auto model = stay_model(stay.cable, models::Coefficients::exact);
  const auto& k = model.coefficients;
  const Vector first = Whirl(false).start();
  const auto line = [](const char* name, double v) { fmt::print("double precision, parameter :: {} = {:.16e}_8\n", name, v); };
  line("w1", model.modes.omega1);
  line("w2", model.modes.omega2);
  line("zeta1", stay.damping_out_of_plane);
  line("zeta2", stay.damping_in_plane);
  line("K", stiffness_rate(stay.cable));
  line("L", stay.cable.chord_length);
  line("sag_ratio", model.shape.sag_ratio);
  line("theta", stay.cable.inclination_deg * (pi / 180.0));
  line("support", stay.support_amplitude);
  line("a2", k.a2);
  line("c2", k.c2);
  line("G1", k.G1);
  line("G2", k.G2);
  line("G3", k.G3);
  line("G4", k.G4);
  fmt::print("double precision, parameter :: first(5) = (/ {:.16e}_8", first[0]);
  for (int i = 1; i < 5; ++i) fmt::print(", {:.16e}_8", first[i]);
  fmt::print(" /)\n");
}

Curve curve_of(const Branch& b) {
  Curve c{b.points() + static_cast<int>(b.special.size()), {}};  // as AUTO counts
  for (const auto& s : b.special) c.special.push_back({to_string(s.type), s.u[4]});
  return c;
}

/// AUTO's fort.7: a line for each point, also for each special one.
Curve read_diagram(const std::filesystem::path& file) {
  const std::map<int, std::string> letters{{1, "BP"}, {2, "LP"}, {3, "HB"}, {5, "LP"}, {6, "BP"}, {7, "PD"}, {8, "TR"}, {-9, "MX"}};
  Curve c;
  std::ifstream in(file);
  for (std::string text; std::getline(in, text);) {
    std::istringstream line(text);
    int branch = 0, point = 0, type = 0, label = 0;
    double omega = 0.0;
    if (!(line >> branch >> point >> type >> label >> omega) || branch == 0) continue;
    ++c.points;
    if (const auto known = letters.find(type % 10); known != letters.end()) c.special.push_back({known->second, omega});
  }
  return c;
}

/// Processor time, user and system, of a whole process [us]; what it prints is dropped.
double time_process(const std::filesystem::path& directory, std::vector<std::string> command) {
  std::vector<char*> arguments;
  for (auto& word : command) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  const auto home = std::filesystem::current_path();
  std::filesystem::current_path(directory);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
  pid_t child = 0;
  int status = 1;
  rusage used{};
  if (posix_spawn(&child, arguments[0], &actions, nullptr, arguments.data(), environ) == 0) wait4(child, &status, 0, &used);
  const double t =
      1e6 * static_cast<double>(used.ru_utime.tv_sec + used.ru_stime.tv_sec) + static_cast<double>(used.ru_utime.tv_usec + used.ru_stime.tv_usec);
  posix_spawn_file_actions_destroy(&actions);
  std::filesystem::current_path(home);
  if (status != 0) throw std::runtime_error(fmt::format("{} failed in {}", command[0], directory.string()));
  return t;
}

struct Row {
  const char* name;
  const char* directory;
  bool short_steps, whirling;
  std::vector<double> ours, theirs;
  Curve our_curve, their_curve;
};

void compare(const std::string& program, const std::filesystem::path& work, int repetitions, const std::string& self) {
  Row rows[] = {{"in-plane", "in-plane", false, false, {}, {}, {}, {}},
                {"whirling", "whirling", false, true, {}, {}, {}, {}},
                {"in-plane, short steps", "in-plane-short", true, false, {}, {}, {}, {}},
                {"whirling, short steps", "whirling-short", true, true, {}, {}, {}, {}}};
  const Whirl whirl[] = {Whirl(false), Whirl(true)};
  std::vector<double> start, our_process;
  for (int i = 0; i < repetitions; ++i) {  // in turn, so that both see the same load
    start.push_back(time_process(work / "start", {program}));
    our_process.push_back(time_process(work, {self, "walk"}));
    for (auto& row : rows) {
      row.theirs.push_back(time_process(work / row.directory, {program}));
      constexpr int walks = 50;
      Branch b;
      const double begin = cpu_microseconds();
      for (int k = 0; k < walks; ++k) b = row.whirling ? whirl[row.short_steps].whirling() : whirl[row.short_steps].in_plane();
      row.ours.push_back((cpu_microseconds() - begin) / walks);
      if (i == 0) {
        row.our_curve = curve_of(b);
        row.their_curve = read_diagram(work / row.directory / "fort.7");
      }
    }
  }

  const double empty = median(start);
  fmt::print("Oresund slow flow, n = 2, U = 0.5 m, omega = {} to {} rad/s; processor time, medians of {} repetitions\n\n", lower, upper, repetitions);
  fmt::print("{:<24}{:^20}{:^32}{:^22}\n", "", "points", "us a point", "AUTO / Whirl");
  fmt::print("{:<24}{:>9}{:>9}{:>12}{:>12}{:>9}{:>13}{:>11}\n", "branch", "AUTO", "Whirl", "AUTO", "AUTO net", "Whirl", "whole", "net");
  const auto print = [&](const char* name, int n_theirs, int n_ours, double theirs, double net, double ours) {
    const double a = theirs / n_theirs, b = net / n_theirs, c = ours / n_ours;
    fmt::print("{:<24}{:>9}{:>9}{:>12.2f}{:>12.2f}{:>9.3f}{:>13.1f}{:>11.1f}\n", name, n_theirs, n_ours, a, b, c, a / c, b / c);
  };
  for (int i = 0; i < 4; ++i) {
    const Row& r = rows[i];
    print(r.name, r.their_curve.points, r.our_curve.points, median(r.theirs), median(r.theirs) - empty, median(r.ours));
    if (i % 2 == 1) {
      const Row& q = rows[i - 1];
      const double theirs = median(q.theirs) + median(r.theirs);
      print("  both", q.their_curve.points + r.their_curve.points, q.our_curve.points + r.our_curve.points, theirs, theirs - 2.0 * empty,
            median(q.ours) + median(r.ours));
    }
  }
  fmt::print("\nAUTO: whole process; net: less the {:.0f} us of a process that computes three points. Whirl: in a running process.\n", empty);
  fmt::print("Both branches, processes from start to end: AUTO {:.0f} us (two), Whirl {:.0f} us (one), ratio {:.1f}.\n\n",
             median(rows[0].theirs) + median(rows[1].theirs), median(our_process),
             (median(rows[0].theirs) + median(rows[1].theirs)) / median(our_process));

  fmt::print("{:<12}{:<6}{:>16}{:>16}{:>12}\n", "branch", "type", "AUTO", "Whirl", "difference");
  for (const auto& row : {rows[0], rows[1]}) {
    auto theirs = row.their_curve.special;
    for (const auto& s : row.our_curve.special) {
      auto nearest = theirs.end();
      for (auto it = theirs.begin(); it != theirs.end(); ++it)
        if (it->type == s.type && std::abs(it->omega - s.omega) < 1e-4 &&
            (nearest == theirs.end() || std::abs(it->omega - s.omega) < std::abs(nearest->omega - s.omega)))
          nearest = it;
      if (nearest == theirs.end()) {
        fmt::print("{:<12}{:<6}{:>16}{:>16.10f}\n", row.name, s.type, "-", s.omega);
        continue;
      }
      fmt::print("{:<12}{:<6}{:>16.10f}{:>16.10f}{:>12.1e}\n", row.name, s.type, nearest->omega, s.omega, nearest->omega - s.omega);
      theirs.erase(nearest);
    }
    for (const auto& s : theirs) fmt::print("{:<12}{:<6}{:>16.10f}{:>16}\n", row.name, s.type, s.omega, "-");
  }
}

// In-plane periodic motions, omega = 1.4 to 2 rad/s. WORK/sweep holds AUTO's run from the orbit at 1.4 rad/s, WORK/load how it got there.
void compare_orbits(const std::string& program, const std::filesystem::path& work, int repetitions) {
  constexpr int harmonics = 20;
  const HarmonicBalance hb = stay_harmonic_balance(stay, {Lens("omega")}, {.harmonics = harmonics});
  const WalkOptions options{.lower = 1.4, .upper = 2.0};
  const Vector start = newton(hb, hb.linear_response(Vector::Constant(1, options.lower))).x;
  std::vector<double> theirs, ours;
  Branch b;
  for (int i = 0; i < repetitions; ++i) {
    theirs.push_back(time_process(work / "sweep", {program}));
    const double begin = cpu_microseconds();
    b = Walker(hb, options).walk(start);
    ours.push_back(cpu_microseconds() - begin);
  }
  double truncation = 0.0;
  for (int i = 0; i < b.points(); ++i) truncation = std::max(truncation, hb.truncation(b.u(i), b.tangent(i)).error);
  const Curve auto_curve = read_diagram(work / "sweep" / "fort.7");
  const int our_points = curve_of(b).points;
  const double a = median(theirs) / auto_curve.points, w = median(ours) / our_points;
  fmt::print("\nExact periodic motions in plane, U = 0.5 m, omega = {} to {} rad/s, with multipliers and events; processor time, medians of {}\n",
             options.lower, options.upper, repetitions);
  fmt::print(
      "AUTO (60 intervals of 4, tolerances 1e-9): {} points, {:.0f} us each. Whirl ({} harmonics, truncation {:.1e}): {} points, {:.0f} us each. "
      "Ratio {:.1f}.\n\n",
      auto_curve.points, a, harmonics, truncation, our_points, w, a / w);
  fmt::print("{:<6}{:>16}{:>16}{:>12}\n", "type", "AUTO", "Whirl", "difference");
  for (const auto& s : b.special)
    for (const auto& t : auto_curve.special)
      if (t.type == to_string(s.type) && std::abs(t.omega - s.u[hb.size()]) < 1e-4)
        fmt::print("{:<6}{:>16.10f}{:>16.10f}{:>12.1e}\n", t.type, t.omega, s.u[hb.size()], t.omega - s.u[hb.size()]);
}

}  // namespace

int main(int argc, char** argv) try {
  const std::string what = argc > 1 ? argv[1] : "";
  if (what == "coefficients" && argc == 2) {
    print_coefficients();
  } else if (what == "walk" && argc == 2) {
    const Whirl whirl(false);  // walks in plane
    if (whirl.whirling().points() < 2) return 1;
  } else if (what == "compare" && argc == 5) {
    compare(argv[2], argv[3], std::stoi(argv[4]), std::filesystem::canonical(argv[0]));
  } else if (what == "orbits" && argc == 5) {
    compare_orbits(argv[2], argv[3], std::stoi(argv[4]));
  } else {
    fmt::print(stderr, "usage: against coefficients | walk | compare AUTO WORK REPETITIONS | orbits AUTO WORK REPETITIONS\n");
    return 2;
  }
} catch (const std::exception& e) {
  fmt::print(stderr, "against: {}\n", e.what());
  return 1;
}
