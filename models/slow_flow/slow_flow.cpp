#include "models/slow_flow/slow_flow.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numbers>
#include <set>

namespace whirl::models {
namespace {

constexpr int max_parameters = ParametricSystem::max_parameters;
constexpr std::size_t max_frozen = 32;  // of one coordinate

std::size_t at(int i) { return static_cast<std::size_t>(i); }

ModalSystem<double> reference_of(const ParametricSystem& system) {
  ModalSystem<double> shape;
  system.at(std::span<const double>(system.reference().data(), at(system.parameters())), shape);
  return shape;
}

// cos(h omega t), folded so that the second half repeats the first to the last bit.
Matrix cosines(int max_harmonic, int nu, int samples) {
  Matrix c(samples, max_harmonic + 1);
  const int half = samples / 2;
  for (int h = 0; h <= max_harmonic; ++h)
    for (int m = 0; m < half; ++m) {
      c(m, h) = std::cos(2.0 * std::numbers::pi * ((h * nu * m) % samples) / samples);
      c(half + m, h) = (h * nu) % 2 == 0 ? c(m, h) : -c(m, h);
    }
  return c;
}

}  // namespace

// A term of degree D times cos(h omega t) reaches harmonic D H + h nu; samples are so many that its image lies above every harmonic asked for.
SlowFlowModel::SlowFlowModel(const ParametricSystem& system, const Ansatz& ansatz) : system_(system), ansatz_(ansatz) {
  ansatz_.validate();
  const ModalSystem<double> shape = reference_of(system_);
  n_ = shape.size();
  if (ansatz_.coordinates() != n_)
    throw std::invalid_argument(fmt::format("the ansatz lists harmonics of {} coordinates, the system has {}", ansatz_.coordinates(), n_));
  size_ = ansatz_.size();
  parameters_ = system_.parameters();
  int degree = 1, highest = ansatz_.highest();
  for (const auto& t : shape.terms) degree = std::max(degree, t.degree);
  frozen_.resize(at(n_));
  for (const auto& f : shape.forces) {
    auto& list = frozen_[at(f.equation)];
    const int k = f.harmonic * ansatz_.nu;
    if (!ansatz_.frozen || ansatz_.index(f.equation, k) >= 0 || k == 0 || std::find(list.begin(), list.end(), k) != list.end()) continue;
    list.push_back(k);
    if (list.size() > max_frozen)
      throw std::invalid_argument(fmt::format("more than {} forced harmonics of one coordinate cannot be frozen", max_frozen));
    highest = std::max(highest, k);
  }
  highest_ = highest;
  samples_ = (degree + 1) * highest + shape.max_harmonic * ansatz_.nu + 1;
  samples_ += samples_ % 2;
  cosine_ = cosines(shape.max_harmonic, ansatz_.nu, samples_);
  for (int i = 0; i < n_; ++i) {
    transform_.emplace_back(ansatz_.harmonics[at(i)], samples_);
    frozen_transform_.emplace_back(frozen_[at(i)], samples_);
    offset_.push_back(ansatz_.offset(i));
  }
  pair_.assign(at(n_ * n_), -1);
  for (const auto& t : shape.terms)
    for (int a = 0; a < t.degree; ++a) {
      const int j = t.factor[at(a)];
      int& number = pair_[at(t.equation * n_ + j)];
      if (number >= 0) continue;
      number = static_cast<int>(pairs_.size());
      std::set<int> needed;
      for (const int k : ansatz_.harmonics[at(t.equation)])
        for (const int l : ansatz_.harmonics[at(j)]) {
          needed.insert(std::abs(k - l));
          needed.insert(k + l);
        }
      Pair pair;
      const std::vector<int> list(needed.begin(), needed.end());
      pair.transform = ListTransform(list, samples_);
      pair.place.assign(at(list.empty() ? 0 : list.back() + 1), -1);
      int place = 0;
      for (const int h : list) {
        pair.place[at(h)] = place;
        place += h > 0 ? 2 : 1;
      }
      gamma_.resize(std::max(gamma_.size(), at(place)));
      pairs_.push_back(std::move(pair));
    }
  std::apply([&](auto&... room) { (make_room(room), ...); }, rooms_);
  g_.resize(at(samples_) * pairs_.size());
  for (auto& s : slope_) s.resize(at(samples_ * n_));
  frozen_slope_.resize(at(samples_));
  y_.resize(size_);
  ys_.resize(size_ * max_parameters);
  scale_.resize(size_);
}

void SlowFlowModel::sample_terms(const ModalSystem<Slopes>& system) const {
  Room<double>& room = std::get<Room<double>>(rooms_);
  std::fill(room.b.begin(), room.b.end(), 0.0);
  std::fill(g_.begin(), g_.end(), 0.0);
  for (int k = 0; k < parameters_; ++k) std::fill(slope_[k].begin(), slope_[k].end(), 0.0);
  for (const auto& t : system.terms) {
    const double* cosine = cosine_.col(t.cos_harmonic).data();
    const int offset = t.equation * samples_;
    term_product(t, -1, room.q.data(), cosine, samples_, room.product.data());
    for (int m = 0; m < samples_; ++m) room.b[at(offset + m)] += room.product[at(m)] * t.coefficient.v;
    for (int k = 0; k < parameters_; ++k)
      if (t.coefficient.d[at(k)] != 0.0)
        for (int m = 0; m < samples_; ++m) slope_[k][at(offset + m)] += room.product[at(m)] * t.coefficient.d[at(k)];
    for (int a = 0; a < t.degree; ++a) {
      const int count = multiplicity(t, a);
      if (count == 0) continue;
      term_product(t, a, room.q.data(), cosine, samples_, room.product.data());
      const double scale = t.coefficient.v * count;
      double* g = g_.data() + samples_ * pair_[at(t.equation * n_ + t.factor[at(a)])];
      for (int m = 0; m < samples_; ++m) g[m] += room.product[at(m)] * scale;
    }
  }
}

// With g = sum over all h of gamma_h e^{i h theta}:  dR_k = gamma_{k-l} dZ_l + gamma_{k+l} conj(dZ_l), a mean l = 0: dR_k = 2 gamma_k dB.
void SlowFlowModel::add_block(int i, int j, MatrixOut out) const {
  const int number = pair_[at(i * n_ + j)];
  if (number < 0) return;
  const Pair& pair = pairs_[at(number)];
  pair.transform.analyse(static_cast<const double*>(g_.data() + number * samples_), gamma_.data());
  const auto gamma = [&](int h) -> std::complex<double> {
    const int place = pair.place[at(std::abs(h))];
    if (h == 0) return gamma_[at(place)];
    return {0.5 * gamma_[at(place)], h > 0 ? 0.5 * gamma_[at(place + 1)] : -0.5 * gamma_[at(place + 1)]};
  };
  int row = offset_[at(i)];
  for (const int k : ansatz_.harmonics[at(i)]) {
    int column = offset_[at(j)];
    const double s = scale_[row];
    for (const int l : ansatz_.harmonics[at(j)]) {
      if (l == 0) {
        const std::complex<double> g = gamma(k);
        if (k == 0) {
          out(row, column) += s * g.real();
        } else {
          out(row, column) -= s * 2.0 * g.imag();
          out(row + 1, column) += s * 2.0 * g.real();
        }
        ++column;
        continue;
      }
      if (k == 0) {
        const std::complex<double> g = gamma(l);
        out(row, column) += s * g.real();
        out(row, column + 1) += s * g.imag();
      } else {
        const std::complex<double> minus = gamma(k - l), plus = gamma(k + l), du = minus + plus, dv = minus - plus;  // dR = du dU + i dv dV
        out(row, column) -= s * du.imag();
        out(row + 1, column) += s * du.real();
        out(row, column + 1) -= s * dv.real();
        out(row + 1, column + 1) -= s * dv.imag();
      }
      column += 2;
    }
    row += k > 0 ? 2 : 1;
  }
}

void SlowFlowModel::linearise(const double* u, double* r, MatrixOut j) const {
  Room<double>& room = std::get<Room<double>>(rooms_);
  std::array<Slopes, max_parameters> p;
  for (int k = 0; k < parameters_; ++k) p[at(k)] = seed<Slopes>(u[size_ + k], k);
  system_.at(std::span<const Slopes>(p.data(), at(parameters_)), slopes_);
  for (int i = 0; i < n_; ++i) transform_[at(i)].synthesise(u + offset_[at(i)], room.q.data() + i * samples_);
  std::array<Slopes, 2 * max_frozen> z;
  for (int i = 0; i < n_; ++i) {
    const std::size_t count = 2 * frozen_[at(i)].size();
    if (count == 0) continue;
    frozen_amplitudes(slopes_, i, z.data());
    for (std::size_t f = 0; f < count; ++f) room.z[f] = z[f].v;
    frozen_transform_[at(i)].synthesise(static_cast<const double*>(room.z.data()), room.extra.data());
    for (int m = 0; m < samples_; ++m) room.q[at(i * samples_ + m)] += room.extra[at(m)];
  }
  sample_terms(slopes_);
  for (int i = 0; i < n_; ++i) {  // the frozen part moves with the parameters
    const std::size_t count = 2 * frozen_[at(i)].size();
    if (count == 0) continue;
    frozen_amplitudes(slopes_, i, z.data());
    for (int k = 0; k < parameters_; ++k) {
      for (std::size_t f = 0; f < count; ++f) room.z[f] = z[f].d[at(k)];
      frozen_transform_[at(i)].synthesise(static_cast<const double*>(room.z.data()), frozen_slope_.data());
      for (int e = 0; e < n_; ++e) {
        const int number = pair_[at(e * n_ + i)];
        if (number < 0) continue;
        for (int m = 0; m < samples_; ++m) slope_[k][at(e * samples_ + m)] += g_[at(number * samples_ + m)] * frozen_slope_[at(m)];
      }
    }
  }
  j.setZero();
  for (int i = 0; i < n_; ++i) {
    const int offset = offset_[at(i)];
    transform_[at(i)].analyse(static_cast<const double*>(room.b.data() + i * samples_), y_.data() + offset);
    for (int k = 0; k < parameters_; ++k)
      transform_[at(i)].analyse(static_cast<const double*>(slope_[k].data() + i * samples_), ys_.data() + k * size_ + offset);
    int row_at = offset;
    for (const int k : ansatz_.harmonics[at(i)]) {
      const int parts = k > 0 ? 2 : 1;
      Slopes amplitude[2], y[2], out[2], scale;
      for (int part = 0; part < parts; ++part) {
        amplitude[part] = Slopes(u[row_at + part]);
        y[part] = Slopes(y_[row_at + part]);
        for (int l = 0; l < parameters_; ++l) y[part].d[at(l)] = ys_[l * size_ + row_at + part];
      }
      for (const auto& f : slopes_.forces)
        if (f.equation == i && f.harmonic * ansatz_.nu == k) y[0] -= f.amplitude;
      row(slopes_, i, k, amplitude, y, out, scale);
      for (int part = 0; part < parts; ++part) {
        r[row_at + part] = out[part].v;
        scale_[row_at + part] = scale.v;
        for (int l = 0; l < parameters_; ++l) j(row_at + part, size_ + l) = out[part].d[at(l)];
      }
      const double K = slopes_.stiffness[at(i)].v, c = slopes_.damping[at(i)].v, speed = slopes_.omega.v * k / ansatz_.nu;
      const double D = K - speed * speed, E = c * speed;
      if (k == 0) {
        j(row_at, row_at) = scale.v * K;
      } else {
        j(row_at, row_at) = j(row_at + 1, row_at + 1) = -scale.v * E;
        j(row_at, row_at + 1) = -scale.v * D;
        j(row_at + 1, row_at) = scale.v * D;
      }
      row_at += parts;
    }
  }
  for (int i = 0; i < n_; ++i)
    for (int l = 0; l < n_; ++l) add_block(i, l, j);
}

std::vector<std::complex<double>> SlowFlowModel::frozen(const ModalSystem<double>& system, int coordinate) const {
  std::vector<double> z(2 * frozen_of(coordinate).size());
  frozen_amplitudes(system, coordinate, z.data());
  std::vector<std::complex<double>> out;
  for (std::size_t f = 0; f < z.size(); f += 2) out.emplace_back(z[f], z[f + 1]);
  return out;
}

// ---- the problem -----------------------------------------------------------------------------------------------------------

SlowFlow::SlowFlow(const ParametricSystem& system, const Ansatz& ansatz, const std::vector<CoordinateReflection>& reflections)
    : DualProblem(SlowFlowModel(system, ansatz), ansatz.size(), system.parameters(), true), r_(ansatz.size()) {
  name_parameters(system.names());
  for (auto& r : reflections_of(ansatz, reference_of(system), reflections)) add_reflection(std::move(r));
}

void SlowFlow::do_jacobian(In u, MatrixOut j) const { model().linearise(u.data(), r_.data(), j); }

void SlowFlow::do_linearise(In u, Out r, MatrixOut j) const { model().linearise(u.data(), r.data(), j); }

ModalSystem<double> SlowFlow::system_at(In u) const {
  ModalSystem<double> system;
  model().system().at(std::span<const double>(u.data() + size(), at(parameters())), system);
  return system;
}

Vector SlowFlow::motion(In u, double t) const {
  const ModalSystem<double> system = system_at(u);
  Vector y = motion_at(ansatz(), u.head(size()), system.omega, t);
  for (int i = 0; i < system.size(); ++i) {
    const auto z = model().frozen(system, i);
    for (std::size_t f = 0; f < z.size(); ++f) {
      const double speed = model().frozen_of(i)[f] * system.omega / ansatz().nu;
      const std::complex<double> turned = z[f] * std::polar(1.0, speed * t);
      y[i] += turned.real();
      y[system.size() + i] -= speed * turned.imag();
    }
  }
  return y;
}

Vector SlowFlow::balance_state(In u) const {
  const int H = balance_harmonics();
  Vector x = models::balance_state(ansatz(), u.head(size()), H);
  const ModalSystem<double> system = system_at(u);
  for (int i = 0; i < system.size(); ++i) {
    const auto z = model().frozen(system, i);
    for (std::size_t f = 0; f < z.size(); ++f) {
      const int place = i * (2 * H + 1) + 2 * model().frozen_of(i)[f];
      x[place - 1] = z[f].real();
      x[place] = -z[f].imag();
    }
  }
  return x;
}

Vector SlowFlow::linear_response(In p) const {
  Vector u(size() + parameters());
  u.tail(parameters()) = p;
  u.head(size()) = linear_state(ansatz(), system_at(u));
  return u;
}

Vector SlowFlow::from_motion(const SteadyMotion& motion, In p) const {
  Vector u(size() + parameters());
  u << state_of(ansatz(), motion), p;
  return u;
}

}  // namespace whirl::models
