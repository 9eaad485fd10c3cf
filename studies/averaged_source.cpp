#include "studies/averaged_source.hpp"

#include <fmt/format.h>

#include <random>

#include "continuation/deflation.hpp"
#include "core/newton.hpp"
#include "studies/common_keys.hpp"
#include "studies/extremes.hpp"
#include "studies/slow_flow_ansatz.hpp"

namespace whirl::studies {
namespace {

using namespace models;
using namespace continuation;

class AveragedSource : public EquilibriumSource {
 public:
  explicit AveragedSource(const Configuration& c) : c_(c), parameter_(c.text("continuation.parameter")), forced_(forced_system_of(c, {parameter_})) {
    ansatz_ = averaged_of(c, forced_).ansatz;
    if (parameter_ == "omega" && c.is_given("omega"))
      throw c.error("omega", "is the continuation parameter: remove it, or choose another continuation.parameter");
  }

  std::unique_ptr<Problem> problem(const std::vector<std::string>& lenses) const override {
    return std::move(averaged_of(c_, forced_system_of(c_, lenses)).flow);
  }
  double value(const std::string& lens) const override { return forced_lens_value(c_, lens); }
  std::string unit(const std::string& lens) const override { return forced_system_of(c_, {lens}).lens_units.front(); }
  std::vector<std::string> warnings() const override {
    auto all = check_forced_system(c_);
    for (auto& w : dropped_forces(forced_, ansatz_)) all.push_back(std::move(w));
    return all;
  }
  std::vector<Branch> marked(const std::vector<Branch>& branches, RunContext& context) const override {
    return with_fast_marked(forced_, ansatz_, branches, context);
  }
  void check_lens(const std::string& key, const std::string& lens, const std::string& range_key, double lower, double upper) const override {
    check_forced_lens(c_, key, lens, range_key, lower, upper);
  }

  std::vector<PointColumn> columns(const Problem&) const override { return harmonic_columns(forced_, ansatz_); }
  std::vector<PointColumn> extremes(const Problem&) const override {
    const Ansatz a = ansatz_;
    const std::string what = a.frozen ? ", of the harmonics kept" : "";
    return extreme_columns(forced_.coordinates, forced_.length_unit, what, [a](In u, int i) {
      std::vector<std::complex<double>> z(static_cast<std::size_t>(a.highest()) + 1);
      for (const int k : a.harmonics[static_cast<std::size_t>(i)]) z[static_cast<std::size_t>(k)] = amplitude(a, u.head(a.size()), i, k);
      return z;
    });
  }
  std::vector<Observable> observables() const override {
    std::vector<Observable> all;
    for (int i = 0; i < ansatz_.coordinates(); ++i)
      for (const int k : ansatz_.harmonics[static_cast<std::size_t>(i)]) {
        const int first = ansatz_.index(i, k);
        all.push_back(
            {.name = harmonic_name(forced_.coordinates[static_cast<std::size_t>(i)], static_cast<double>(k) / ansatz_.nu),
             .form = k == 0 ? QuadraticForm::coordinate(ansatz_.size(), first) : QuadraticForm::square_sum(ansatz_.size(), {first, first + 1})});
      }
    return all;
  }
  Network::Namer namer() const override {
    return [this](const Branch& b) { return motion_prefix(forced_, ansatz_, b); };
  }

  // The linear response at both ends; at values between, whatever deflated Newton reaches from states at random, some of its size and some large.
  std::vector<Start> starts(const Problem& f, const std::string& lens, double lower, double upper) const override {
    constexpr int grid = 7, random_states = 6;
    const int n = f.size();
    std::vector<Start> all;
    const auto linear = [&](double p) {
      Vector u(n + 1);
      u << linear_state(ansatz_, forced_.at(Vector::Constant(1, p))), p;
      return u;
    };
    for (const double p : {lower, upper})
      if (const NewtonResult r = newton(f, linear(p), patient); r.ok()) all.push_back({r.x, fmt::format("linear response at {} = {:.6g}", lens, p)});
    std::mt19937 random(1);
    std::uniform_real_distribution<double> entry(-1.0, 1.0);
    for (int g = 0; g < grid; ++g) {
      const double p = lower + (upper - lower) * (g + 0.5) / grid;
      std::vector<Vector> from{linear(p)};
      const double size = from.front().head(n).lpNorm<Eigen::Infinity>();
      for (int k = 0; k < random_states; ++k) {
        Vector u = Vector::NullaryExpr(n + 1, [&] { return (k % 2 == 0 ? 2.0 * size : std::max(3.0, 10.0 * size)) * entry(random); });
        u[n] = p;
        from.push_back(u);
      }
      for (const auto& u : deflated_solutions(f, {}, from)) all.push_back({u, fmt::format("deflation at {} = {:.6g}", lens, p)});
    }
    for (auto& s : all) s.u = symmetric_to_the_bit(f, s.u);
    return all;
  }
  void write(ResultFile& file, RunContext& context) const override {
    write_forced_system(file, context, c_);
    file.attribute("/study", "nu", static_cast<double>(ansatz_.nu));
  }

 private:
  static constexpr NewtonOptions patient{.tolerance = 1e-11, .max_iterations = 50};
  Configuration c_;
  std::string parameter_;
  ForcedSystem forced_;
  Ansatz ansatz_;
};

}  // namespace

std::unique_ptr<EquilibriumSource> averaged_source(const Configuration& c) { return std::make_unique<AveragedSource>(c); }

}  // namespace whirl::studies
