#include "models/catenary/reduced.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <map>

#include "core/symmetric_pencil.hpp"
#include "models/catenary/largest.hpp"

namespace whirl::models::catenary {
namespace {

// Kept modes at the mesh points and as coefficients, largest displacement 1.
struct Kept {
  Matrix e, N, W_x;  // one column a coordinate
  Matrix q, w;       // coefficients in plane, out of plane
};

using Powers = std::vector<int>;

class Condensation {
 public:
  Condensation(const CoreCable& c, const ReducedOptions& o, int functions)
      : c_(c), lateral_count_(o.out_of_plane), planar_count_(o.in_plane), g_(c.x1, c.x2, functions), lateral_(c.x1, c.x2, functions) {
    K_ = g_.stiffness(c.kappa);
    const Vector& cosh = g_.mesh().c;
    h_ = g_.mesh().weight.array() * ((c.kappa * cosh.array()).inverse() - 1.0);
    keep();
  }

  ReducedModel model() {
    add_cubic();
    add_quartic();
    for (const auto& [powers, value] : energy_) model_.energy.push_back({powers, value});
    for (const auto& [powers, value] : direct_) model_.direct.push_back({powers, value});
    return model_;
  }

 private:
  int count() const { return lateral_count_ + planar_count_; }

  void keep() {
    const Mesh& mesh = g_.mesh();
    const auto points = mesh.t.size();
    model_.out_of_plane = lateral_count_;
    model_.in_plane = planar_count_;
    model_.omega.resize(count());
    model_.mass.resize(count());
    model_.tangential_share.setZero(count());
    kept_ = {Matrix::Zero(points, count()), Matrix::Zero(points, count()), Matrix::Zero(points, count()), Matrix::Zero(K_.rows(), count()),
             Matrix::Zero(lateral_.size(), count())};
    const PencilModes across = lowest_modes(lateral_.stiffness(), lateral_.mass(), lateral_count_);
    for (int i = 0; i < lateral_count_; ++i) {
      const Vector q = across.vectors.col(i), W = lateral_.W().leftCols(lateral_.size()) * q,
                   slope = lateral_.W_slope().leftCols(lateral_.size()) * q;
      Matrix at(points, 2);
      at << W, slope;
      const Field<double> field{mesh.coordinate, mesh.project(at)};
      const double scale = sign_at_lower_end(W) / largest_lateral(mesh, field, W, -across.omega[i] * across.omega[i]);
      kept_.W_x.col(i) = scale * slope;
      kept_.w.col(i) = scale * q;
      note(i, across.omega[i], scale);
    }
    const PencilModes planar = lowest_modes(K_, g_.mass(c_.kappa), planar_count_, true, 1);
    model_.first_left_out = planar.omega[planar_count_];
    for (int i = 0; i < planar_count_; ++i) {
      const Vector q = planar.vectors.col(i);
      const auto at = g_.nodal<double>(c_.kappa, q, Eigen::Vector4d::Zero());
      const double L = -planar.omega[i] * planar.omega[i];
      const double largest = largest_displacement<double>(mesh, field_of<double>(mesh, at, L, L), at, c_.kappa, L, L);
      const double scale = sign_at_lower_end(at.V) / largest;
      const int k = lateral_count_ + i;
      kept_.e.col(k) = scale * std::sqrt(c_.kappa) * (g_.R() * q);
      kept_.N.col(k) = scale * at.N;
      kept_.q.col(k) = scale * q;
      model_.tangential_share[k] = mesh.weight.cwiseProduct(mesh.c).dot(at.U.cwiseAbs2());  // q' M q = 1
      note(k, planar.omega[i], scale);
    }
  }

  void note(int i, double omega, double scale) {
    model_.omega[i] = omega;
    model_.mass[i] = scale * scale;  // q' M q = 1 before
  }

  static void add(std::map<Powers, double>& to, int size, std::initializer_list<int> factors, double value) {
    Powers powers(std::size_t(size), 0);
    for (const int i : factors) ++powers[std::size_t(i)];
    if (value != 0.0) to[powers] += value;
  }

  // G of the product of coordinates i and j, once for each order of the two.
  Vector stretch(int i, int j) const {
    return (0.5 * (kept_.N.col(i).array() * kept_.N.col(j).array() + kept_.W_x.col(i).array() * kept_.W_x.col(j).array()) / g_.mesh().c.array())
        .matrix();
  }

  void add_cubic() {
    for (int k = lateral_count_; k < count(); ++k)
      for (int i = 0; i < count(); ++i)
        for (int j = 0; j < count(); ++j) add(energy_, count(), {k, i, j}, h_.dot(kept_.e.col(k).cwiseProduct(stretch(i, j))));
  }

  void add_quartic() {
    const int n = count();
    const auto size = Eigen::Index(n) * n;
    const Vector& c = g_.mesh().c;
    Matrix G(c.size(), size), F(K_.rows(), size), FW(lateral_.size(), size);
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j) {
        const auto p = Eigen::Index(i) * n + j;
        G.col(p) = stretch(i, j);
        const Vector along = h_.cwiseProduct(G.col(p)), pull = h_.cwiseProduct(kept_.e.col(i)).cwiseQuotient(c);
        F.col(p) = std::sqrt(c_.kappa) * (g_.R().transpose() * along);
        F.col(p) += scaled_slopes().transpose() * pull.cwiseProduct(kept_.N.col(j));
        FW.col(p) = lateral_.W_slope().leftCols(lateral_.size()).transpose() * pull.cwiseProduct(kept_.W_x.col(j));
      }
    Matrix follow = K_.llt().solve(F), follow_W = lateral_.stiffness().llt().solve(FW);  // with the opposite sign
    for (int k = 0; k < n; ++k) {                                                        // kept modes do not follow
      const double stiffness = model_.mass[k] * model_.omega[k] * model_.omega[k];
      if (k < lateral_count_) follow_W -= kept_.w.col(k) * (kept_.w.col(k).transpose() * FW) / stiffness;
      else follow -= kept_.q.col(k) * (kept_.q.col(k).transpose() * F) / stiffness;
    }
    const Matrix direct = 0.5 * (G.transpose() * h_.asDiagonal() * G);
    const Matrix condensed = direct - 0.5 * (F.transpose() * follow + FW.transpose() * follow_W);
    const Matrix inertia = follow.transpose() * g_.mass(c_.kappa) * follow + follow_W.transpose() * lateral_.mass() * follow_W;
    add_inertia(inertia);
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j)
        for (int k = 0; k < n; ++k)
          for (int l = 0; l < n; ++l) {
            add(energy_, n, {i, j, k, l}, condensed(Eigen::Index(i) * n + j, Eigen::Index(k) * n + l));
            add(direct_, n, {i, j, k, l}, direct(Eigen::Index(i) * n + j, Eigen::Index(k) * n + l));
          }
  }

  // The average over nonresonant motion of 1/2 r_t' M r_t, r = sum follow_ij xi_i xi_j, taken for that of a potential.
  void add_inertia(const Matrix& inertia) {
    const int n = count();
    const auto at = [&](int i, int j) { return Eigen::Index(i) * n + j; };
    for (int i = 0; i < n; ++i) {
      const double w2 = model_.omega[i] * model_.omega[i];
      add(energy_, n, {i, i, i, i}, -2.0 / 3.0 * w2 * inertia(at(i, i), at(i, i)));
      for (int j = 0; j < i; ++j) {
        const double both = inertia(at(i, j), at(i, j)) + 2.0 * inertia(at(i, j), at(j, i)) + inertia(at(j, i), at(j, i));
        add(energy_, n, {i, i, j, j}, -0.5 * both * (w2 + model_.omega[j] * model_.omega[j]));
      }
    }
  }

  // N of every function: F with the factor s of those that stretch.
  Matrix scaled_slopes() const {
    Matrix slopes = g_.F().leftCols(K_.rows());
    slopes.rightCols(K_.rows() - g_.functions()) *= std::sqrt(c_.kappa);
    return slopes;
  }

  CoreCable c_;
  int lateral_count_, planar_count_;
  InPlaneGalerkin g_;
  LateralGalerkin lateral_;
  Matrix K_;
  Vector h_;
  Kept kept_;
  ReducedModel model_;
  std::map<Powers, double> energy_, direct_;
};

}  // namespace

double ReducedModel::coefficient(const std::vector<int>& powers) const {
  for (const Monomial& m : energy)
    if (m.powers == powers) return m.coefficient;
  return 0.0;
}

ReducedModel reduced_model(const CoreCable& c, const ReducedOptions& o) {
  if (!(c.kappa > 0.0)) throw std::invalid_argument("a reduced model needs a flexibility kappa > 0; 1e-7 stands for an inextensible cable");
  if (o.out_of_plane < 0 || o.in_plane < 0 || o.out_of_plane + o.in_plane < 1 || o.out_of_plane + o.in_plane > 12)
    throw std::invalid_argument(fmt::format("a reduced model has 1 to 12 modes, got {} out of plane and {} in plane", o.out_of_plane, o.in_plane));
  // Products of two modes have twice their waves.
  return Condensation(c, o, functions_for(c, 2 * std::max(o.out_of_plane, o.in_plane) + 8) + 8).model();
}

ModalModel in_si_units(const ReducedModel& r, const HangingCable& cable) {
  const CoreCable core = core_of(cable);
  const double unit = frequency_unit(cable), a = cable.shape.a;
  ModalModel model;
  model.frequency.clear();
  for (int i = 0; i < r.omega.size(); ++i) {
    model.frequency.push_back(unit * r.omega[i]);
    const double share = r.tangential_share[i];
    model.damping.push_back(unit * (i < r.out_of_plane ? core.eta3 : share * core.eta1 + (1.0 - share) * core.eta2));
  }
  for (const Monomial& m : r.energy) {
    int degree = 0;
    for (const int p : m.powers) degree += p;
    for (std::size_t i = 0; i < m.powers.size(); ++i) {
      if (m.powers[i] == 0) continue;
      ModalModel::Term term{int(i), m.coefficient * m.powers[i] / r.mass[Eigen::Index(i)] * unit * unit / std::pow(a, degree - 2), m.powers};
      --term.powers[i];
      model.terms.push_back(term);
    }
  }
  return model;
}

double backbone_curvature(const ReducedModel& r, int i) {
  if (i < 0 || i >= r.omega.size()) throw std::invalid_argument(fmt::format("there is no coordinate {}", i));
  const auto n = std::size_t(r.omega.size());
  const double w2 = r.omega[i] * r.omega[i];
  std::vector<int> powers(n, 0);
  powers[std::size_t(i)] = 4;
  double sum = 3.0 * r.coefficient(powers);
  for (std::size_t k = 0; k < n; ++k) {  // xi_i^2 xi_k drives xi_k at 0 and 2 w
    std::fill(powers.begin(), powers.end(), 0);
    powers[std::size_t(i)] = 2;
    ++powers[k];
    const double f = r.coefficient(powers), own = r.omega[Eigen::Index(k)] * r.omega[Eigen::Index(k)], m = r.mass[Eigen::Index(k)];
    const double force = k == std::size_t(i) ? 3.0 * f : f;  // dV/dxi_k over xi_i^2
    sum -= force * force / m * (1.0 / own + 0.5 / (own - 4.0 * w2));
  }
  return sum / (2.0 * w2 * r.mass[i]);
}

}  // namespace whirl::models::catenary
