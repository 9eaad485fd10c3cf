#include "continuation/curve.hpp"

namespace whirl::continuation {
Curve::Curve(const Problem& f, Blocks blocks, const CurveOptions& options)
    : f_(f),
      orbit_(dynamic_cast<const OrbitProblem*>(&f)),
      blocks_(std::move(blocks)),
      options_(options),
      spectrum_(blocks_),
      eigenvalues_(Eigen::VectorXcd::Zero(orbit_ ? spectrum_size(f) : 0)),
      group_(Eigen::VectorXi::Zero(spectrum_size(f))),
      parts_(orbit_ ? 1 : static_cast<int>(blocks_.indices.size())),
      weight_(Vector::Ones(f.size() + 1)),
      r_(f.size()),
      normal_(Vector::Zero(f.size() + 1)),
      whole_(blocks_.indices.size() == 1),
      state_(static_cast<int>(blocks_.indices[0].size())),
      solution_(state_ + 1),
      rhs_(state_ + 1),
      refined_(state_ + 1),
      last_(Vector::Unit(state_ + 1, state_)),
      tangent_(state_ + 1),
      bordered_(state_ + 1, state_ + 1),
      own_jacobian_(whole_ ? 0 : f.size(), f.size() + 1),
      jacobian_(whole_ ? bordered_.topRows(f.size()) : own_jacobian_.topRows(f.size())),
      lu_(state_ + 1) {
  if (f.parameters() != 1) throw std::invalid_argument("a curve needs exactly one free parameter");
  if (blocks_.indices.size() > Signature::max_blocks) throw std::invalid_argument("more than 8 symmetry blocks");
  for (const auto& indices : blocks_.indices) {
    const auto m = static_cast<Eigen::Index>(indices.size());
    block_.emplace_back(m, m);
    block_lu_.emplace_back(m);
  }
}

int Curve::spectrum_size(const Problem& f) {
  if (const auto* orbit = dynamic_cast<const OrbitProblem*>(&f)) return orbit->multiplier_count();
  return f.is_flow() ? f.size() : 0;
}

void Curve::set_scales(double x_scale, double p_scale) {
  x_scale_ = x_scale;
  p_scale_ = p_scale;
  weight_.setConstant(1.0 / (x_scale * x_scale));
  weight_[f_.size()] = 1.0 / (p_scale * p_scale);
}

// The bordered matrix of the coordinates that the symmetries leave: of the others r, steps and tangents are zero.
void Curve::border() {
  const int n = f_.size();
  if (whole_) {
    for (int c = 0; c <= n; ++c) bordered_(n, c) = normal_[c];
    return;
  }
  const Indices& even = blocks_.indices[0];
  for (int c = 0; c < state_; ++c) {
    const int column = even[static_cast<std::size_t>(c)];
    for (int r = 0; r < state_; ++r) bordered_(r, c) = jacobian_(even[static_cast<std::size_t>(r)], column);
    bordered_(state_, c) = normal_[column];
  }
  for (int r = 0; r < state_; ++r) bordered_(r, state_) = jacobian_(even[static_cast<std::size_t>(r)], n);
  bordered_(state_, state_) = normal_[n];
}

// An answer of the bordered system in all coordinates.
void Curve::spread(const Vector& from, double scale, Out answer) const {
  double* to = answer.data();
  if (whole_) {
    for (int i = 0; i <= state_; ++i) to[i] = scale * from[i];
    return;
  }
  for (int i = 0; i < f_.size(); ++i) to[i] = 0.0;
  for (int i = 0; i < state_; ++i) to[blocks_.indices[0][static_cast<std::size_t>(i)]] = scale * from[i];
  to[f_.size()] = scale * from[state_];
}

// u <- u + an answer of the bordered system.
void Curve::add(const Vector& answer, Out u) const {
  double* to = u.data();
  for (int i = 0; i < state_; ++i) to[whole_ ? i : blocks_.indices[0][static_cast<std::size_t>(i)]] += answer[i];
  to[f_.size()] += answer[state_];
}

// Of an answer of the bordered system.
double Curve::length_of(const Vector& from) const {
  double sum = 0.0;
  for (int i = 0; i < state_; ++i) sum += from[i] * from[i];
  return std::sqrt(sum * weight_[0] + from[state_] * from[state_] * weight_[f_.size()]);
}

// Of the bordered system for the correction at u.
void Curve::right_side(Out u, In anchor) {
  for (int i = 0; i < state_; ++i) rhs_[i] = -r_[whole_ ? i : blocks_.indices[0][static_cast<std::size_t>(i)]];
  double off = 0.0;
  for (int i = 0; i < u.size(); ++i) off += (u[i] - anchor[i]) * normal_[i];
  rhs_[state_] = -off;
}

Curve::Report Curve::correct(Out u, In normal, In anchor, bool strict) {
  Report report;
  const double last_step = strict ? std::min(options_.last_step, 1e-14) : options_.last_step;
  double previous = 0.0;
  normal_ = normal.array() * weight_.array();
  for (;;) {
    f_.linearise(u, r_, jacobian_);
    report.residual = r_.lpNorm<Eigen::Infinity>();
    if (!std::isfinite(report.residual)) return report;  // of the Jacobian: the step or the tangent is not finite then
    border();
    if (report.iterations > 0 && settle(u, anchor, previous, last_step, report)) return report;
    if (report.iterations == options_.max_iterations) return report;
    lu_.compute(bordered_);
    right_side(u, anchor);
    lu_.solve(rhs_, solution_);
    const double size = length_of(solution_);
    if (!std::isfinite(size)) return report;
    if (report.iterations == 0) report.first_step = size;
    if (report.iterations > 0 && size > 2.0 * previous && size > 1e3 * options_.tolerance) return report;
    add(solution_, u);
    ++report.iterations;
    previous = size;
  }
}

// A last step with the factors of the step before it, if it contracts enough; else nothing happens. The tangent's first guess comes along.
bool Curve::settle(Out u, In anchor, double previous, double last_step, Report& report) {
  right_side(u, anchor);
  lu_.solve_two(rhs_, last_, solution_, tangent_);
  // Where the step before was tiny, what this one adds is rounding and says nothing of the contraction: that is at most most_curved times it.
  constexpr double most_curved = 1e3, tiny = 1e-9;
  const double size = length_of(solution_), rate = size > 0.0 ? std::min(size / previous, most_curved * previous) : 0.0;
  if (report.iterations == 1) report.contraction = rate;
  const bool rounding = previous < tiny && size > 0.1 * previous && size < tiny;
  if (!(size == 0.0 || rounding || (size <= last_step && size * rate < options_.tolerance))) return false;
  add(solution_, u);
  ++report.iterations;
  f_.residual(u, r_);
  report.residual = r_.lpNorm<Eigen::Infinity>();
  report.ok = std::isfinite(report.residual);
  return true;
}

// y <- y - B x, B the bordered matrix at the point.
void Curve::subtract_product(const Vector& x, Vector& y) const {
  const double* b = bordered_.data();
  for (int c = 0; c <= state_; ++c) {
    const double t = x[c];
    for (int r = 0; r <= state_; ++r) y[r] -= *b++ * t;
  }
}

// The last column of the inverse of the bordered matrix. The factors are a correction old: where they do not contract, new ones.
bool Curve::refine_tangent() {
  for (int pass = 0; pass < 3; ++pass) {
    for (int i = 0; i <= state_; ++i) rhs_[i] = last_[i];
    subtract_product(tangent_, rhs_);
    lu_.solve(rhs_, refined_);
    double change = 0.0, size = 0.0;
    for (int i = 0; i <= state_; ++i) {
      change += refined_[i] * refined_[i];
      size += tangent_[i] * tangent_[i];
      tangent_[i] += refined_[i];
    }
    if (!(change < 1e-6 * size)) break;
    if (change < 1e-11 * size) return true;  // the next change would be its square
  }
  lu_.compute(bordered_);
  lu_.solve(last_, tangent_);
  return tangent_.allFinite();
}

bool Curve::tangent(Out tangent) {
  if (!refine_tangent()) return false;
  const double size = length_of(tangent_);
  if (!std::isfinite(size) || size == 0.0) return false;
  spread(tangent_, 1.0 / size, tangent);
  return true;
}

bool Curve::classify(In u, In tangent, Signature& signature) {
  constexpr double upright = 1e-13;  // a parameter that stays put along a curve turns by rounding all the way
  signature.forward = tangent[f_.size()] > -upright * p_scale_;
  if (!f_.is_flow()) {
    block_determinants(signature, signature.forward);
    return !orbit_ || count_multipliers(u, signature);
  }
  if (!spectrum_.compute(jacobian_)) return false;
  for (int k = 0; k < static_cast<int>(blocks_.indices.size()); ++k) {
    const auto slot = static_cast<std::size_t>(k);
    rates_[slot] = spectrum_.rates(k);
    signature.unstable[slot] = rates_[slot].positive();
    signature.negative[slot] = (blocks_.indices[slot].size() - static_cast<std::size_t>(signature.unstable[slot])) % 2 == 1;
  }
  return true;
}

// det r_x = t_p det [J; t'] in the coordinates of the motion itself; the others have determinants of their own.
void Curve::block_determinants(Signature& signature, bool forward) {
  signature.negative[0] = lu_.negative_determinant() ^ !forward;
  for (std::size_t k = 1; k < blocks_.indices.size(); ++k) {
    const auto& indices = blocks_.indices[k];
    for (std::size_t c = 0; c < indices.size(); ++c)
      for (std::size_t r = 0; r < indices.size(); ++r) block_[k](static_cast<int>(r), static_cast<int>(c)) = jacobian_(indices[r], indices[c]);
    block_lu_[k].compute(block_[k]);
    signature.negative[k] = block_lu_[k].negative_determinant();
  }
}

bool Curve::count_multipliers(In u, Signature& signature) {
  if (!orbit_->multipliers(u, eigenvalues_, group_) || !eigenvalues_.allFinite()) return false;
  signature.unstable.fill(0);
  signature.above.fill(0);
  signature.flips.fill(0);
  for (auto& r : rates_) r.clear();
  for (Eigen::Index i = 0; i < eigenvalues_.size(); ++i) {
    const std::complex<double> mu = eigenvalues_[i];
    const auto slot = static_cast<std::size_t>(group_[i]);
    const double excess = std::abs(mu) - 1.0;
    parts_ = std::max(parts_, group_[i] + 1);
    rates_[slot].add(excess);
    if (!(excess > 0.0)) continue;
    ++signature.unstable[slot];
    if (mu.imag() == 0.0) ++(mu.real() > 0.0 ? signature.above : signature.flips)[slot];
  }
  return true;
}

bool Curve::sample(In guess, In normal, Sample& out) {
  out.u = guess;
  const Report report = correct(out.u, normal, guess, true);
  out.tangent.resize(f_.size() + 1);
  if (!report.ok || !complete(out.u, out.tangent, out.signature)) return false;
  out.residual = report.residual;
  out.iterations = report.iterations;
  copy_spectrum(out);
  return true;
}

void Curve::copy_spectrum(Sample& to) const {
  copy_rates(to);
  if (f_.is_flow())
    for (int k = 0; k < parts_; ++k) to.kappa[static_cast<std::size_t>(k)] = spectrum_.kappa(k);
}

// Cubic Hermite through both ends, moved back into the plane at fraction sigma normal to the chord, so that fractions mean what they say.
void Curve::interpolate(const Sample& a, const Sample& b, double sigma, Vector& u) const {
  const double h = length(b.u - a.u), s = sigma, s2 = s * s, s3 = s2 * s;
  u = (2.0 * s3 - 3.0 * s2 + 1.0) * a.u + (s3 - 2.0 * s2 + s) * h * a.tangent + (3.0 * s2 - 2.0 * s3) * b.u + (s3 - s2) * h * b.tangent;
  u += (sigma - dot(b.u - a.u, u - a.u) / (h * h)) * (b.u - a.u);
}

bool Curve::between(const Sample& a, const Sample& b, double sigma, Sample& out) {
  Vector guess;
  interpolate(a, b, sigma, guess);
  return sample(guess, b.u - a.u, out);
}

void Curve::guess(const Sample& a, const Sample& b, double sigma, Sample& out) const {
  const double h = length(b.u - a.u), s = sigma;
  interpolate(a, b, sigma, out.u);
  out.tangent = (6.0 * s * (s - 1.0) / h) * (a.u - b.u) + (1.0 + s * (3.0 * s - 4.0)) * a.tangent + s * (3.0 * s - 2.0) * b.tangent;
  out.tangent /= length(out.tangent);
}

bool Curve::peek(const Sample& a, const Sample& b, double sigma, Sample& out) {
  guess(a, b, sigma, out);
  f_.jacobian(out.u, jacobian_);
  if (!classify(out.u, out.tangent, out.signature)) return false;
  copy_spectrum(out);
  return true;
}

}  // namespace whirl::continuation
