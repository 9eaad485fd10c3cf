#include "models/harmonic_balance.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <bit>
#include <numbers>

namespace whirl::models {
namespace {

constexpr double two_pi = 2.0 * std::numbers::pi;
constexpr int max_parameters = ParametricSystem::max_parameters;
using Slopes = ParametricSystem::Slopes;
using Along = ParametricSystem::Along;
using SlopesAlong = ParametricSystem::SlopesAlong;
using Triple = ParametricSystem::Triple;

std::size_t at(int i) { return static_cast<std::size_t>(i); }

// The part of a scalar that is asked for: the value, or the slope along the direction of `second`.
double pick(double x) { return x; }
double pick(const Along& x) { return x.d[0]; }

int largest_degree(const ModalSystem<double>& system) {
  int degree = 1;
  for (const auto& t : system.terms) degree = std::max(degree, t.degree);
  return degree;
}

struct OverOmega {
  ModalSystem<double> base;

  template <class S>
  void operator()(std::span<const S> p, ModalSystem<S>& out) const {
    out.omega = p[0];
    out.damping.assign(base.damping.begin(), base.damping.end());
    out.stiffness.assign(base.stiffness.begin(), base.stiffness.end());
    out.terms.resize(base.terms.size());
    for (std::size_t i = 0; i < base.terms.size(); ++i) {
      const auto& t = base.terms[i];
      out.terms[i] = {t.equation, S(t.coefficient), t.degree, t.factor, t.cos_harmonic};
    }
    out.forces.resize(base.forces.size());
    for (std::size_t i = 0; i < base.forces.size(); ++i)
      out.forces[i] = {base.forces[i].equation, S(base.forces[i].amplitude), base.forces[i].harmonic};
    out.max_harmonic = base.max_harmonic;
  }
};

class StayMaker {
 public:
  StayMaker(const StayParameters<double>& stay, std::vector<Lens> lenses, Terms terms, Coefficients coefficients)
      : stay_(stay), lenses_(std::move(lenses)), terms_(terms), coefficients_(coefficients), model_(stay_model(stay.cable, coefficients)) {
    for (const auto& lens : lenses_) cable_moves_ = cable_moves_ || lens.affects_cable();
  }

  template <class S>
  void operator()(std::span<const S> p, ModalSystem<S>& out) const {
    StayParameters<S> record = promote<S>(stay_);
    for (std::size_t i = 0; i < lenses_.size(); ++i) lenses_[i].set(record, p[i]);
    nielsen_kirkegaard(record, cable_moves_ ? stay_model(record.cable, coefficients_) : constant_model<S>(), terms_, out);
  }

 private:
  // Only numbers that leave statics and modes alone: what the constructor computed.
  template <class S>
  StayModel<S> constant_model() const {
    const auto& shape = model_.shape;
    const auto& m = model_.modes;
    const auto& k = model_.coefficients;
    return {{S(shape.sag), S(shape.sag_ratio), S(shape.irvine_lambda2)},
            {S(m.frequency_number), S(m.omega1), S(m.omega2), S(m.shape_denominator)},
            {S(k.m1), S(k.m2), S(k.a1), S(k.a2), S(k.c1), S(k.c2), S(k.d1), S(k.d2), S(k.d3), S(k.C1), S(k.C2), S(k.C3), S(k.C4), S(k.G1), S(k.G2),
             S(k.G3), S(k.G4)}};
  }

  StayParameters<double> stay_;
  std::vector<Lens> lenses_;
  Terms terms_;
  Coefficients coefficients_;
  StayModel<double> model_;
  bool cable_moves_ = false;
};

}  // namespace

// ---- systems ---------------------------------------------------------------------------------------------------------------

void ParametricSystem::validate() const {
  if (parameters() > max_parameters) throw std::invalid_argument(fmt::format("at most {} free parameters, got {}", max_parameters, parameters()));
  if (reference_.size() != parameters())
    throw std::invalid_argument(fmt::format("{} parameter names but {} reference values", parameters(), reference_.size()));
}

ParametricSystem ParametricSystem::over_omega(const ModalSystem<double>& system) {
  return ParametricSystem(OverOmega{system}, {"omega"}, Vector::Constant(1, system.omega));
}

ParametricSystem stay_system(const StayParameters<double>& stay, const std::vector<Lens>& lenses, Terms terms, Coefficients coefficients) {
  std::vector<std::string> names;
  Vector reference(static_cast<Eigen::Index>(lenses.size()));
  for (const auto& lens : lenses) {
    reference[static_cast<Eigen::Index>(names.size())] = lens.get(stay);
    names.push_back(lens.name());
  }
  return ParametricSystem(StayMaker(stay, lenses, terms, coefficients), std::move(names), std::move(reference));
}

HarmonicBalance stay_harmonic_balance(const StayParameters<double>& stay, const std::vector<Lens>& lenses, HarmonicBalanceOptions options,
                                      Terms terms, Coefficients coefficients) {
  options.reflections.push_back({{-1, 1}, "WH"});
  return HarmonicBalance(stay_system(stay, lenses, terms, coefficients), options);
}

// ---- transforms ------------------------------------------------------------------------------------------------------------

HarmonicTransform::HarmonicTransform(int harmonics, int samples) : samples_(samples) {
  if (samples % 2 != 0) throw std::invalid_argument("a folded transform needs an even number of samples");
  const int half = samples / 2;
  place_[0].push_back(0);
  for (int k = 1; k <= harmonics; ++k)
    for (int part : {2 * k - 1, 2 * k}) place_[k % 2].push_back(part);
  for (int parity : {0, 1}) {
    const int columns = static_cast<int>(place_[parity].size());
    basis_[parity].resize(half, columns);
    for (int c = 0; c < columns; ++c) {
      const int part = place_[parity][at(c)], k = (part + 1) / 2;
      for (int m = 0; m < half; ++m) {
        const double theta = two_pi * ((k * m) % samples) / samples;
        basis_[parity](m, c) = part % 2 == 1 || part == 0 ? std::cos(theta) : std::sin(theta);
      }
    }
    projection_[parity] = basis_[parity].transpose() * (2.0 / samples);
    if (parity == 0) projection_[0].row(0) *= 0.5;
    x_[parity].resize(columns);
    f_[parity].resize(half);
  }
}

void HarmonicTransform::synthesise(const double* x, double* f) const {
  const int half = samples_ / 2;
  for (int parity : {0, 1}) {
    for (std::size_t c = 0; c < place_[parity].size(); ++c) x_[parity][static_cast<Eigen::Index>(c)] = x[place_[parity][c]];
    f_[parity].noalias() = basis_[parity] * x_[parity];
  }
  for (int m = 0; m < half; ++m) {
    f[m] = f_[0][m] + f_[1][m];
    f[half + m] = f_[0][m] - f_[1][m];
  }
}

void HarmonicTransform::analyse(const double* f, double* x) const {
  const int half = samples_ / 2;
  for (int m = 0; m < half; ++m) {
    f_[0][m] = f[m] + f[half + m];
    f_[1][m] = f[m] - f[half + m];
  }
  for (int parity : {0, 1}) {
    x_[parity].noalias() = projection_[parity] * f_[parity];
    for (std::size_t c = 0; c < place_[parity].size(); ++c) x[place_[parity][c]] = x_[parity][static_cast<Eigen::Index>(c)];
  }
}

// ---- construction ----------------------------------------------------------------------------------------------------------

void HarmonicBalanceOptions::validate() const {
  if (harmonics < 1 || harmonics > 2000) throw std::invalid_argument(fmt::format("harmonics must be in 1..2000, got {}", harmonics));
  if (nu < 1 || nu > 64) throw std::invalid_argument(fmt::format("nu must be in 1..64, got {}", nu));
  floquet.validate();
}

template <class Q>
void HarmonicBalance::Samples<Q>::resize(int unknowns, int samples, int coordinates, int pairs) {
  x.resize(at(unknowns));
  q.resize(at(samples * coordinates));
  b.resize(at(samples * coordinates));
  product.resize(at(samples));
  g.resize(at(samples * pairs));
  for (auto& s : slope) s.resize(at(samples * coordinates));
}

ModalSystem<double> HarmonicBalance::shape_of(const ParametricSystem& system, const HarmonicBalanceOptions& options) {
  options.validate();
  ModalSystem<double> shape;
  system.at(std::span<const double>(system.reference().data(), at(system.parameters())), shape);
  return shape;
}

HarmonicBalance::HarmonicBalance(const ParametricSystem& system, const HarmonicBalanceOptions& options)
    : HarmonicBalance(system, options, shape_of(system, options)) {}

HarmonicBalance::HarmonicBalance(const ParametricSystem& system, const HarmonicBalanceOptions& options, const ModalSystem<double>& shape)
    : OrbitProblem(shape.size() * (2 * options.harmonics + 1), system.parameters(), 2 * shape.size()),
      system_(system),
      options_(options),
      n_(shape.size()),
      width_(2 * options.harmonics + 1),
      system_value_(shape),
      floquet_(shape, options.harmonics, options.nu, options.floquet) {
  name_parameters(system_.names());
  offer_derivatives(3);
  // A term of degree D times cos(h omega t) reaches harmonic D H + h nu; sampled so that its image lies above H.
  const int H = options_.harmonics;
  samples_ = (largest_degree(system_value_) + 1) * H + system_value_.max_harmonic * options_.nu + 1;
  samples_ += samples_ % 2;
  transform_ = HarmonicTransform(H, samples_);
  wide_ = HarmonicTransform(2 * H, samples_);
  cosine_ = cosines(system_value_.max_harmonic, options_.nu, samples_);
  find_pairs(system_value_);
  value_.resize(size(), samples_, n_, pairs_);
  along_.resize(size(), samples_, n_, pairs_);
  triple_.resize(size(), samples_, n_, pairs_);
  r_.resize(size());
  signal_.resize(samples_);
  harmonic_.resize(4 * H + 1);
  c_.resize(4 * H + 1);
  s_.resize(4 * H + 1);
  find_reflections(system_value_);
}

Matrix HarmonicBalance::cosines(int max_harmonic, int nu, int samples) {
  Matrix c(samples, max_harmonic + 1);
  const int half = samples / 2;
  for (int h = 0; h <= max_harmonic; ++h)
    for (int m = 0; m < half; ++m) {
      c(m, h) = std::cos(two_pi * ((h * nu * m) % samples) / samples);
      c(half + m, h) = (h * nu) % 2 == 0 ? c(m, h) : -c(m, h);
    }
  return c;
}

void HarmonicBalance::find_pairs(const ModalSystem<double>& system) {
  pair_.assign(at(n_ * n_), -1);
  for (const auto& t : system.terms)
    for (int a = 0; a < t.degree; ++a) {
      int& p = pair_[at(t.equation * n_ + t.factor[at(a)])];
      if (p < 0) p = pairs_++;
    }
}

// Signs s_i and a shift by half the base period, theta -> theta + pi, are a symmetry if every term and force of equation i keeps s_i: linear
// equations over {0, 1} for the flips, s_i = (-1)^flip_i. Their least solution, bit i for coordinate i; nothing if there is none.
std::optional<std::uint64_t> HarmonicBalance::shift_symmetry(const ModalSystem<double>& system, int nu) {
  struct Row {
    std::uint64_t flips;
    bool odd;
  };
  const auto bit = [](int i) { return std::uint64_t{1} << i; };
  std::vector<Row> rows;  // each has a leading bit that no other row has
  const auto add = [&](std::uint64_t flips, bool odd) {
    for (const Row& r : rows)
      if ((flips & std::bit_floor(r.flips)) != 0) {
        flips ^= r.flips;
        odd ^= r.odd;
      }
    if (flips == 0) return !odd;
    for (Row& r : rows)
      if ((r.flips & std::bit_floor(flips)) != 0) r = {r.flips ^ flips, r.odd != odd};
    rows.push_back({flips, odd});
    return true;
  };
  const auto odd = [nu](int h) { return (h * nu) % 2 != 0; };
  for (const auto& t : system.terms) {
    std::uint64_t flips = bit(t.equation);
    for (int a = 0; a < t.degree; ++a) flips ^= bit(t.factor[at(a)]);
    if (!add(flips, odd(t.cos_harmonic))) return std::nullopt;
  }
  for (const auto& f : system.forces)
    if (!add(bit(f.equation), odd(f.harmonic))) return std::nullopt;
  std::uint64_t least = 0;  // free coordinates keep their sign: the leading bits are the highest of their rows
  for (const Row& r : rows)
    if (r.odd) least |= std::bit_floor(r.flips);
  return least;
}

void HarmonicBalance::find_reflections(const ModalSystem<double>& system) {
  using Flips = std::uint64_t;  // bit i: coordinate i changes sign
  if (n_ > 63) throw std::invalid_argument("harmonic balance knows at most 63 coordinates");
  const auto add = [&](Flips flips, bool shifted, const std::string& subtype) {
    Vector signs(size());
    for (int i = 0; i < n_; ++i)
      for (int c = 0; c < width_; ++c) signs[i * width_ + c] = (((flips >> i) & 1u) != 0) != (shifted && ((c + 1) / 2) % 2 == 1) ? -1.0 : 1.0;
    check_reflection({signs, subtype});
    add_reflection({signs, subtype});
  };
  const auto mask = [&](const CoordinateReflection& r) {
    if (static_cast<int>(r.signs.size()) != n_) throw std::invalid_argument(fmt::format("a reflection needs {} signs, got {}", n_, r.signs.size()));
    Flips flips = 0;
    for (int i = 0; i < n_; ++i) {
      if (std::abs(r.signs[at(i)]) != 1) throw std::invalid_argument("the signs of a reflection are +1 or -1");
      if (r.signs[at(i)] < 0) flips |= Flips{1} << i;
    }
    return flips;
  };
  const std::optional<Flips> base = shift_symmetry(system, nu());
  if (base && *base == 0) add(0, true, "PD");
  std::vector<Flips> group = {0};  // of the coordinate reflections
  for (const auto& r : options_.reflections) {
    const Flips flips = mask(r);
    add(flips, false, r.subtype);
    const std::size_t known = group.size();
    if (std::find(group.begin(), group.end(), flips) == group.end() && known < 8)
      for (std::size_t i = 0; i < known; ++i) group.push_back(group[i] ^ flips);
  }
  if (!base) return;
  for (const Flips flips : group)
    if ((*base ^ flips) != 0) add(*base ^ flips, true, "SB");
}

// r(S x) = S r(x) at an arbitrary x.
void HarmonicBalance::check_reflection(const Reflection& reflection) const {
  Vector u(size() + parameters()), v, r(size()), s(size());
  for (int i = 0; i < size(); ++i) u[i] = std::sin(1.0 + 2.3 * i) / (1.0 + (i % width_));
  u.tail(parameters()) = system_.reference();
  v = u;
  v.head(size()).array() *= reflection.signs.array();
  residual(u, r);
  residual(v, s);
  // rounding of sums of some hundred samples
  if (!((s - (r.array() * reflection.signs.array()).matrix()).lpNorm<Eigen::Infinity>() <= 1e-11 * (1.0 + r.lpNorm<Eigen::Infinity>())))
    throw std::invalid_argument(fmt::format("the equations do not have the reflection \"{}\"", reflection.subtype));
}

// ---- residual and derivatives ----------------------------------------------------------------------------------------------

void HarmonicBalance::synthesise(const double* x, double* q) const {
  for (int i = 0; i < n_; ++i) transform_.synthesise(x + i * width_, q + i * samples_);
}

template <class Q>
void HarmonicBalance::residual_samples(const ModalSystem<Q>& system, Samples<Q>& s) const {
  std::fill(s.b.begin(), s.b.end(), Q(0.0));
  for (const auto& t : system.terms) {
    term_product(t, -1, s.q.data(), cosine_.col(t.cos_harmonic).data(), samples_, s.product.data());
    Q* b = s.b.data() + t.equation * samples_;
    for (int m = 0; m < samples_; ++m) b[m] += s.product[at(m)] * t.coefficient;
  }
}

// Rows k of coordinate `row` without the terms: mass, damping, stiffness.
template <class Q, class S>
void HarmonicBalance::linear_part(const ModalSystem<S>& system, const Samples<Q>& s, int row, int k, S& cosine, S& sine) const {
  const S a(s.x[at(index(row, k))]);
  if (k == 0) {
    cosine = system.stiffness[at(row)] * a;
    return;
  }
  const S b(s.x[at(index(row, k) + 1)]), speed = system.omega * (static_cast<double>(k) / options_.nu);
  const S D = system.stiffness[at(row)] - speed * speed, E = system.damping[at(row)] * speed;
  cosine = D * a + E * b;
  sine = D * b - E * a;
}

void HarmonicBalance::do_residual(In u, Out r) const {
  Samples<double>& s = value_;
  system_.at(std::span<const double>(u.data() + size(), at(parameters())), system_value_);
  std::copy(u.data(), u.data() + size(), s.x.begin());
  synthesise(u.data(), s.q.data());
  residual_samples(system_value_, s);
  for (int i = 0; i < n_; ++i) {
    transform_.analyse(s.b.data() + i * samples_, r_.data() + i * width_);
    for (int k = 0; k <= harmonics(); ++k) {
      double cosine = 0.0, sine = 0.0;
      linear_part(system_value_, s, i, k, cosine, sine);
      r_[index(i, k)] += cosine;
      if (k > 0) r_[index(i, k) + 1] += sine;
    }
  }
  for (const auto& f : system_value_.forces)
    if (f.harmonic * nu() <= harmonics()) r_[index(f.equation, f.harmonic * nu())] -= f.amplitude;
  r = r_;
}

void HarmonicBalance::do_jacobian(In u, MatrixOut j) const { do_linearise(u, r_, j); }

void HarmonicBalance::do_linearise(In u, Out r, MatrixOut j) const {
  std::array<Slopes, max_parameters> p;
  for (int k = 0; k < parameters(); ++k) p[at(k)] = seed<Slopes>(u[size() + k], k);
  system_.at(std::span<const Slopes>(p.data(), at(parameters())), system_slopes_);
  std::copy(u.data(), u.data() + size(), value_.x.begin());
  synthesise(u.data(), value_.q.data());
  differentiate(system_slopes_, value_, r.data(), j);
}

void HarmonicBalance::do_second(In u, In v, MatrixOut h) const {
  std::array<SlopesAlong, max_parameters> p;
  for (int k = 0; k < parameters(); ++k) {
    p[at(k)].v = Along(u[size() + k]);
    p[at(k)].v.d[0] = v[size() + k];
    p[at(k)].d[at(k)] = Along(1.0);
  }
  system_.at(std::span<const SlopesAlong>(p.data(), at(parameters())), system_along_);
  Samples<Along>& s = along_;
  for (int i = 0; i < size(); ++i) {
    s.x[at(i)] = Along(u[i]);
    s.x[at(i)].d[0] = v[i];
  }
  synthesise(u.data(), value_.q.data());
  synthesise(v.data(), value_.b.data());
  for (std::size_t m = 0; m < s.q.size(); ++m) {
    s.q[m].v = value_.q[m];
    s.q[m].d[0] = value_.b[m];
  }
  differentiate(system_along_, s, nullptr, h);
}

// Jacobian [r_x r_p] (Q double) or its slope along a direction (Q a dual); r if asked for and Q is double.
template <class Q>
void HarmonicBalance::differentiate(const ModalSystem<Dual<Q, max_parameters>>& system, Samples<Q>& s, double* r, MatrixOut j) const {
  using S = Dual<Q, max_parameters>;
  const int H = harmonics(), K = parameters();
  std::fill(s.g.begin(), s.g.end(), Q(0.0));
  std::fill(s.b.begin(), s.b.end(), Q(0.0));
  for (int k = 0; k < K; ++k) std::fill(s.slope[at(k)].begin(), s.slope[at(k)].end(), Q(0.0));
  for (const auto& t : system.terms) {
    const double* cosine = cosine_.col(t.cos_harmonic).data();
    term_product(t, -1, s.q.data(), cosine, samples_, s.product.data());
    const int offset = t.equation * samples_;
    for (int m = 0; m < samples_; ++m) s.b[at(offset + m)] += s.product[at(m)] * t.coefficient.v;
    for (int k = 0; k < K; ++k)
      for (int m = 0; m < samples_; ++m) s.slope[at(k)][at(offset + m)] += s.product[at(m)] * t.coefficient.d[at(k)];
    for (int a = 0; a < t.degree; ++a) {
      const int count = multiplicity(t, a);
      if (count == 0) continue;
      term_product(t, a, s.q.data(), cosine, samples_, s.product.data());
      const Q scale = t.coefficient.v * static_cast<double>(count);
      Q* g = s.g.data() + samples_ * pair_[at(t.equation * n_ + t.factor[at(a)])];
      for (int m = 0; m < samples_; ++m) g[m] += s.product[at(m)] * scale;
    }
  }
  j.setZero();
  for (int i = 0; i < n_; ++i)
    for (int l = 0; l < n_; ++l) {
      const int pair = pair_[at(i * n_ + l)];
      if (pair < 0) continue;
      for (int m = 0; m < samples_; ++m) signal_[m] = pick(s.g[at(pair * samples_ + m)]);
      add_toeplitz(i, l, j);
    }
  for (int i = 0; i < n_; ++i) {
    if (r) {
      for (int m = 0; m < samples_; ++m) signal_[m] = value_of(s.b[at(i * samples_ + m)]);
      transform_.analyse(signal_.data(), r + i * width_);
    }
    for (int k = 0; k < K; ++k) {
      for (int m = 0; m < samples_; ++m) signal_[m] = pick(s.slope[at(k)][at(i * samples_ + m)]);
      transform_.analyse(signal_.data(), harmonic_.data());
      j.col(size() + k).segment(i * width_, width_) = harmonic_.head(width_);
    }
    for (int k = 0; k <= H; ++k) {
      const int row = index(i, k);
      S cosine(0.0), sine(0.0);
      linear_part(system, s, i, k, cosine, sine);
      const int rows = k > 0 ? 2 : 1;
      const S& stiffness = system.stiffness[at(i)];
      const S speed = system.omega * (static_cast<double>(k) / nu());
      const Q D = (stiffness - speed * speed).v, E = (system.damping[at(i)] * speed).v;
      for (int part = 0; part < rows; ++part) {
        const S& value = part == 0 ? cosine : sine;
        if (r) r[row + part] += value_of(value);
        for (int l = 0; l < K; ++l) j(row + part, size() + l) += pick(value.d[at(l)]);
        j(row + part, row + part) += pick(D);
      }
      if (k > 0) {
        j(row, row + 1) += pick(E);
        j(row + 1, row) -= pick(E);
      }
    }
  }
  for (const auto& f : system.forces) {
    if (f.harmonic * nu() > H) continue;
    const int row = index(f.equation, f.harmonic * nu());
    if (r) r[row] -= value_of(f.amplitude);
    for (int l = 0; l < K; ++l) j(row, size() + l) -= pick(f.amplitude.d[at(l)]);
  }
}

// Harmonics of g(t) y_l for every basis function y_l, g in signal_: sums and differences of the harmonics of g.
void HarmonicBalance::add_toeplitz(int i, int l, MatrixOut out) const {
  const int H = harmonics(), middle = 2 * H;
  wide_.analyse(signal_.data(), harmonic_.data());
  c_[middle] = 2.0 * harmonic_[0];
  s_[middle] = 0.0;
  for (int k = 1; k <= 2 * H; ++k) {
    c_[middle + k] = c_[middle - k] = harmonic_[2 * k - 1];
    s_[middle + k] = harmonic_[2 * k];
    s_[middle - k] = -harmonic_[2 * k];
  }
  const double *C = c_.data() + middle, *S = s_.data() + middle;
  double* mean = &out(i * width_, l * width_);
  mean[0] = 0.5 * C[0];
  for (int k = 1; k <= H; ++k) {
    mean[2 * k - 1] = C[k];
    mean[2 * k] = S[k];
  }
  for (int c = 1; c <= H; ++c) {
    double *cosine = &out(i * width_, l * width_ + 2 * c - 1), *sine = &out(i * width_, l * width_ + 2 * c);
    cosine[0] = 0.5 * C[c];
    sine[0] = 0.5 * S[c];
    for (int k = 1; k <= H; ++k) {
      cosine[2 * k - 1] = 0.5 * (C[k + c] + C[k - c]);
      cosine[2 * k] = 0.5 * (S[k + c] + S[k - c]);
      sine[2 * k - 1] = 0.5 * (S[k + c] - S[k - c]);
      sine[2 * k] = 0.5 * (C[k - c] - C[k + c]);
    }
  }
}

void HarmonicBalance::do_third(In u, In a, In b, In c, Out t) const {
  const auto triple = [](double v, double x, double y, double z) {
    Triple r(v);
    r.v.v.d[0] = x;
    r.v.d[0].v = y;
    r.d[0].v.v = z;
    return r;
  };
  const auto along_all = [](const Triple& x) { return x.d[0].d[0].d[0]; };
  Samples<Triple>& s = triple_;
  std::array<Triple, max_parameters> p;
  for (int k = 0; k < parameters(); ++k) p[at(k)] = triple(u[size() + k], a[size() + k], b[size() + k], c[size() + k]);
  system_.at(std::span<const Triple>(p.data(), at(parameters())), system_triple_);
  for (int i = 0; i < size(); ++i) s.x[at(i)] = triple(u[i], a[i], b[i], c[i]);
  synthesise(u.data(), value_.q.data());
  for (std::size_t m = 0; m < s.q.size(); ++m) s.q[m] = Triple(value_.q[m]);
  synthesise(a.data(), value_.q.data());
  for (std::size_t m = 0; m < s.q.size(); ++m) s.q[m].v.v.d[0] = value_.q[m];
  synthesise(b.data(), value_.q.data());
  for (std::size_t m = 0; m < s.q.size(); ++m) s.q[m].v.d[0].v = value_.q[m];
  synthesise(c.data(), value_.q.data());
  for (std::size_t m = 0; m < s.q.size(); ++m) s.q[m].d[0].v.v = value_.q[m];
  residual_samples(system_triple_, s);
  for (int i = 0; i < n_; ++i) {
    for (int m = 0; m < samples_; ++m) signal_[m] = along_all(s.b[at(i * samples_ + m)]);
    transform_.analyse(signal_.data(), r_.data() + i * width_);
    for (int k = 0; k <= harmonics(); ++k) {
      Triple cosine(0.0), sine(0.0);
      linear_part(system_triple_, s, i, k, cosine, sine);
      r_[index(i, k)] += along_all(cosine);
      if (k > 0) r_[index(i, k) + 1] += along_all(sine);
    }
  }
  for (const auto& f : system_triple_.forces)
    if (f.harmonic * nu() <= harmonics()) r_[index(f.equation, f.harmonic * nu())] -= along_all(f.amplitude);
  t = r_;
}

// ---- what a motion looks like ----------------------------------------------------------------------------------------------

ModalSystem<double> HarmonicBalance::system_at(In u) const {
  ModalSystem<double> system;
  system_.at(std::span<const double>(u.data() + size(), at(parameters())), system);
  return system;
}

Eigen::MatrixXcd HarmonicBalance::observe(In u) const {
  Eigen::MatrixXcd z(n_, harmonics() + 1);
  for (int i = 0; i < n_; ++i) {
    z(i, 0) = u[index(i, 0)];
    for (int k = 1; k <= harmonics(); ++k) z(i, k) = {u[index(i, k)], -u[index(i, k) + 1]};
  }
  return z;
}

Vector HarmonicBalance::state_at(In u, double t) const {
  const double base = system_at(u).omega / nu();
  Vector y = Vector::Zero(2 * n_);
  for (int i = 0; i < n_; ++i) {
    y[i] = u[index(i, 0)];
    for (int k = 1; k <= harmonics(); ++k) {
      const double a = u[index(i, k)], b = u[index(i, k) + 1], c = std::cos(k * base * t), s = std::sin(k * base * t);
      y[i] += a * c + b * s;
      y[n_ + i] += k * base * (b * c - a * s);
    }
  }
  return y;
}

double HarmonicBalance::tail(In u) const {
  const Eigen::MatrixXd amplitude = observe(u).cwiseAbs();
  const double largest = amplitude.maxCoeff();
  return largest > 0.0 ? amplitude.rightCols(std::min(2 * nu(), harmonics())).maxCoeff() / largest : 0.0;
}

// The full equations leave residual harmonics R_k, k > H, all of them finite in number. To first order they move the motion by
//     d_k = -R_k / (K - k^2 Omega^2 + i c k Omega)  above H,      d_low = -J^{-1} <g d_high>  below.
Truncation HarmonicBalance::truncation(In u, const Vector& tangent) const {
  const ModalSystem<double> system = system_at(u);
  const int H = harmonics();
  const int top = std::max(largest_degree(system) * H + system.max_harmonic * nu(), H + 1);
  if (!fine_) {
    fine_ = std::make_shared<const HarmonicTransform>(top, 2 * top + 2);
    fine_cosine_ = cosines(system.max_harmonic, nu(), 2 * top + 2);
  }
  const int M = fine_->samples(), wide = 2 * top + 1;
  const double base = system.omega / nu();
  Matrix x = Matrix::Zero(wide, n_), q(M, n_), b = Matrix::Zero(M, n_), high = Matrix::Zero(wide, n_), d(M, n_), gd = Matrix::Zero(M, n_);
  x.topRows(width_) = Eigen::Map<const Matrix>(u.data(), width_, n_);
  for (int i = 0; i < n_; ++i) fine_->synthesise(x.col(i).data(), q.col(i).data());
  Vector product(M);
  for (const auto& t : system.terms) {
    term_product(t, -1, q.data(), fine_cosine_.col(t.cos_harmonic).data(), M, product.data());
    b.col(t.equation) += t.coefficient * product;
  }
  Vector sum = Vector::Zero(n_), moved = Vector::Zero(n_);
  for (int i = 0; i < n_; ++i) {
    Vector h(wide);
    fine_->analyse(b.col(i).data(), h.data());
    for (const auto& f : system.forces)
      if (f.equation == i && f.harmonic > 0) h[2 * f.harmonic * nu() - 1] -= f.amplitude;
    for (int k = H + 1; k <= top; ++k) {
      const std::complex<double> R(h[2 * k - 1], -h[2 * k]),
          stiffness(system.stiffness[at(i)] - k * k * base * base, system.damping[at(i)] * k * base);
      const std::complex<double> z = -R / stiffness;
      high(2 * k - 1, i) = z.real();
      high(2 * k, i) = -z.imag();
      sum[i] += std::abs(R);
      moved[i] += std::abs(z);
    }
    fine_->synthesise(high.col(i).data(), d.col(i).data());
  }
  for (const auto& t : system.terms)
    for (int a = 0; a < t.degree; ++a) {
      const int count = multiplicity(t, a);
      if (count == 0) continue;
      term_product(t, a, q.data(), fine_cosine_.col(t.cos_harmonic).data(), M, product.data());
      gd.col(t.equation).array() += t.coefficient * count * product.array() * d.col(t.factor[at(a)]).array();
    }
  Vector low(size()), h(wide);
  for (int i = 0; i < n_; ++i) {
    fine_->analyse(gd.col(i).data(), h.data());
    low.segment(i * width_, width_) = h.head(width_);
  }
  Matrix j(size(), size() + parameters());
  jacobian(u, j);
  double shift = 0.0;  // of the parameter, relative
  if (tangent.size() == 0) {
    low = j.leftCols(size()).partialPivLu().solve(low).eval();
  } else {
    Matrix bordered(size() + 1, size() + 1);
    bordered << j.leftCols(size() + 1), tangent.head(size() + 1).transpose();
    Vector rhs(size() + 1);
    rhs << low, 0.0;
    rhs = bordered.partialPivLu().solve(rhs).eval();
    low = rhs.head(size());
    shift = std::abs(rhs[size()]) / std::max(std::abs(u[size()]), 1e-300);
  }
  const Eigen::MatrixXd change = observe(low).cwiseAbs();
  for (int i = 0; i < n_; ++i) moved[i] += change.row(i).sum();
  const double largest = observe(u).cwiseAbs().maxCoeff();
  return {sum.maxCoeff(), std::max(largest > 0.0 ? moved.maxCoeff() / largest : moved.maxCoeff(), shift)};
}

// Amplitudes fall geometrically in the end: their rate between the largest ones of the third and of the last quarter of the harmonics.
int HarmonicBalance::harmonics_for(In u, double factor) const {
  const Eigen::MatrixXd amplitude = observe(u).cwiseAbs();
  const int H = harmonics(), quarter = std::max(1, H / 4);
  const double late = amplitude.rightCols(quarter).maxCoeff(), early = amplitude.middleCols(H + 1 - 2 * quarter, quarter).maxCoeff();
  const double rate = late > 0.0 && early > late ? std::log(early / late) / quarter : 0.05;
  return H + std::max(nu(), static_cast<int>(std::ceil(std::log(std::max(1.0 / factor, 1.0)) / rate)));
}

const FloquetResult& HarmonicBalance::floquet(In u, const Floquet::Blocks& blocks) const {
  system_.at(std::span<const double>(u.data() + size(), at(parameters())), system_value_);
  return floquet_.compute(system_value_, u.head(size()), blocks);
}

// ---- stability ---------------------------------------------------------------------------------------------------------------

unsigned HarmonicBalance::reflections_at(In u) const {
  unsigned active = 0;
  for (std::size_t r = 0; r < options_.reflections.size(); ++r) {
    bool keeps = true;
    for (int i = 0; i < n_ && keeps; ++i)
      if (options_.reflections[r].signs[at(i)] < 0) keeps = (u.segment(i * width_, width_).array() == 0.0).all();
    active |= keeps ? 1u << r : 0u;
  }
  return active;
}

int HarmonicBalance::group_of_coordinate(unsigned active, int coordinate) const {
  // Group 0 keeps every sign; the others are numbered as their sign patterns appear.
  const auto pattern = [&](int i) {
    unsigned odd = 0;
    for (std::size_t r = 0; r < options_.reflections.size(); ++r)
      if ((active >> r & 1u) != 0 && options_.reflections[r].signs[at(i)] < 0) odd |= 1u << r;
    return odd;
  };
  const unsigned own = pattern(coordinate);
  if (own == 0) return 0;
  int number = 1;
  for (int i = 0; i < coordinate; ++i) {
    const unsigned other = pattern(i);
    if (other == own) return group_of_coordinate(active, i);
    bool first = other != 0;
    for (int l = 0; l < i && first; ++l) first = pattern(l) != other;
    number += first ? 1 : 0;
  }
  return std::min(number, max_groups - 1);
}

bool HarmonicBalance::do_multipliers(In u, Eigen::VectorXcd& mu, Eigen::VectorXi& group) const {
  const FloquetResult& result = floquet(u);
  if (!result.converged) return false;
  const unsigned active = reflections_at(u);
  mu = result.multipliers;
  Eigen::Index next = 0;
  for (const auto& block : result.blocks) {
    const auto count = 2 * static_cast<Eigen::Index>(block.size());
    group.segment(next, count).setConstant(group_of_coordinate(active, block.front()));
    next += count;
  }
  return true;
}

int HarmonicBalance::do_group_of_unknown(In u, int i) const { return group_of_coordinate(reflections_at(u), i / width_); }

double HarmonicBalance::do_base_frequency(In u) const {
  system_.at(std::span<const double>(u.data() + size(), at(parameters())), system_value_);
  return system_value_.omega / nu();
}

// C = 2 d/dt + c: of y = a cos k theta + b sin k theta the rows of cos and sin get 2 k Omega b + c a, -2 k Omega a + c b.
void HarmonicBalance::do_velocity(In u, int slope, MatrixOut out) const {
  std::array<Slopes, max_parameters> p;
  for (int k = 0; k < parameters(); ++k) p[at(k)] = seed<Slopes>(u[size() + k], k);
  system_.at(std::span<const Slopes>(p.data(), at(parameters())), system_slopes_);
  const auto part = [slope](const Slopes& x) { return slope < 0 ? x.v : x.d[at(slope)]; };
  const double base = part(system_slopes_.omega) / nu();
  out.setZero();
  for (int i = 0; i < n_; ++i) {
    out.diagonal().segment(i * width_, width_).setConstant(part(system_slopes_.damping[at(i)]));
    for (int k = 1; k <= harmonics(); ++k) {
      out(index(i, k), index(i, k) + 1) = 2.0 * k * base;
      out(index(i, k) + 1, index(i, k)) = -2.0 * k * base;
    }
  }
}

const OrbitProblem& HarmonicBalance::do_doubled() const {
  if (!doubled_.problem) doubled_.problem = std::make_shared<const HarmonicBalance>(with_nu(2 * nu(), 2 * harmonics()));
  return *doubled_.problem;
}

Vector HarmonicBalance::do_in_doubled(In u) const {
  (void)do_doubled();
  return doubled_.problem->carry(*this, u);
}

Vector HarmonicBalance::do_from_doubled(In u) const {
  (void)do_doubled();
  Vector v(size() + parameters());
  v.tail(parameters()) = u.tail(parameters());
  for (int i = 0; i < n_; ++i)
    for (int k = 0; k <= harmonics(); ++k) {
      v[index(i, k)] = u[doubled_.problem->index(i, 2 * k)];
      if (k > 0) v[index(i, k) + 1] = u[doubled_.problem->index(i, 2 * k) + 1];
    }
  return v;
}

// ---- start values and other numbers of harmonics ---------------------------------------------------------------------------

Vector HarmonicBalance::linear_response(In p) const {
  Vector u = Vector::Zero(size() + parameters());
  u.tail(parameters()) = p;
  const ModalSystem<double> system = system_at(u);
  for (const auto& f : system.forces) {
    const int k = f.harmonic * nu(), i = f.equation;
    if (k > harmonics()) continue;
    const double speed = f.harmonic * system.omega, K = system.stiffness[at(i)];
    const std::complex<double> z = f.amplitude / std::complex<double>(K - speed * speed, system.damping[at(i)] * speed);
    u[index(i, k)] += z.real();
    if (k > 0) u[index(i, k) + 1] -= z.imag();
  }
  return u;
}

Vector HarmonicBalance::from_motion(const SteadyMotion& motion, In p) const {
  if (motion.kind != MotionKind::periodic || nu() % motion.multiple != 0)
    throw std::invalid_argument(fmt::format("a motion over {} excitation periods cannot start a balance over {}", motion.multiple, nu()));
  Vector u = Vector::Zero(size() + parameters());
  u.tail(parameters()) = p;
  const auto resolved = motion.record.cols() / 2 * nu() / motion.record_periods;  // harmonics below half the sampling rate
  for (int i = 0; i < n_; ++i)
    for (int k = 0; k <= harmonics() && k < resolved; ++k) {
      const std::complex<double> z = motion.harmonic(i, static_cast<double>(k) / nu());
      u[index(i, k)] = z.real();
      if (k > 0) u[index(i, k) + 1] = -z.imag();
    }
  return u;
}

Vector HarmonicBalance::carry(const HarmonicBalance& from, In u) const {
  if (from.n_ != n_ || nu() % from.nu() != 0 || from.parameters() != parameters() || u.size() != from.size() + from.parameters())
    throw std::invalid_argument("a motion can be carried only between balances of one system, to a multiple of its period");
  const int factor = nu() / from.nu();
  Vector v = Vector::Zero(size() + parameters());
  v.tail(parameters()) = u.tail(parameters());
  for (int i = 0; i < n_; ++i)
    for (int k = 0; k <= from.harmonics() && k * factor <= harmonics(); ++k) {
      v[index(i, k * factor)] = u[from.index(i, k)];
      if (k > 0) v[index(i, k * factor) + 1] = u[from.index(i, k) + 1];
    }
  return v;
}

HarmonicBalance HarmonicBalance::with_harmonics(int harmonics) const { return with_nu(nu(), harmonics); }

HarmonicBalance HarmonicBalance::with_nu(int nu, int harmonics) const {
  HarmonicBalanceOptions o = options_;
  o.nu = nu;
  o.harmonics = harmonics;
  return HarmonicBalance(system_, o);
}

void OrbitOptions::validate() const {
  if (!(tolerance > 0.0)) throw std::invalid_argument(fmt::format("orbit tolerance must be > 0, got {}", tolerance));
  if (max_harmonics < 1) throw std::invalid_argument(fmt::format("max_harmonics must be >= 1, got {}", max_harmonics));
  newton.validate();
}

Orbit solve_orbit(const HarmonicBalance& problem, const Vector& start, const OrbitOptions& options) {
  options.validate();
  Orbit orbit;
  orbit.problem = std::make_shared<HarmonicBalance>(problem);
  orbit.u = start;
  for (;;) {
    const HarmonicBalance& hb = *orbit.problem;
    orbit.newton = newton(hb, orbit.u, options.newton);
    if (!orbit.newton.ok()) return orbit;
    orbit.u = orbit.newton.x;
    orbit.truncation = hb.truncation(orbit.u);
    orbit.ok = orbit.truncation.error <= options.tolerance;
    if (orbit.ok || hb.harmonics() >= options.max_harmonics) return orbit;
    const int more = std::max(2 * hb.nu(), hb.harmonics() / 4);
    auto finer = std::make_shared<HarmonicBalance>(hb.with_harmonics(std::min(hb.harmonics() + more, options.max_harmonics)));
    orbit.u = finer->carry(hb, orbit.u);
    orbit.problem = std::move(finer);
  }
}

}  // namespace whirl::models
