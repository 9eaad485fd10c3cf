#include "models/dynamics/periodic/gauss_jet.hpp"

namespace whirl::models {

GaussJet::GaussJet(const Problem& flow) : flow_(flow), n_(flow.size()), second_(flow.size(), flow.size() + flow.parameters()), third_(flow.size()) {
  x.fill(Vector::Zero(n_));
  p.fill(Vector::Zero(flow.parameters()));
  for (auto* stages : {&k_, &y_})
    for (Parts& stage : *stages) stage.fill(Vector::Zero(n_));
  for (Parts& stage : u_) stage.fill(Vector::Zero(n_ + flow.parameters()));
}

// Y_S, with the K_R known so far.
void GaussJet::stage_points(const GaussStep& step, std::size_t part) {
  for (std::size_t i = 0; i < GaussStep::stages; ++i) {
    Vector& y = y_[i][part];
    y = x[part];
    for (std::size_t j = 0; j < GaussStep::stages; ++j)
      for (std::size_t r = 0; r <= part; ++r)
        if ((r & part) == r) y += (step.a[i][j] * h[part ^ r]) * k_[j][r];
    u_[i][part] << y, p[part];
  }
}

// D2f and D3f of the parts of a mixed derivative.
Vector GaussJet::higher(std::size_t stage, std::size_t part) {
  const Parts& u = u_[stage];
  Vector sum = Vector::Zero(n_);
  for (std::size_t r = 1; r < part; ++r) {  // each pair of complements once
    if ((r & part) != r || r > (part ^ r)) continue;
    flow_.second(u[0], u[r], second_);
    sum += second_ * u[part ^ r];
  }
  if (part == whole) {
    flow_.third(u[0], u[1], u[2], u[4], third_);
    sum += third_;
  }
  return sum;
}

void GaussJet::advance(const GaussStep& step) {
  constexpr auto stages = static_cast<std::size_t>(GaussStep::stages);
  Vector right(GaussStep::stages * n_);
  for (std::size_t part = 0; part < parts; ++part) {
    for (std::size_t i = 0; i < stages; ++i) k_[i][part].setZero();
    if (part == 0) {
      for (std::size_t i = 0; i < stages; ++i) k_[i][0] = step.slopes().col(static_cast<int>(i));
    } else {
      stage_points(step, part);
      for (std::size_t i = 0; i < stages; ++i) {
        const auto rows = static_cast<Eigen::Index>(i) * n_;
        right.segment(rows, n_) = step.jacobian(static_cast<int>(i)) * u_[i][part] + higher(i, part);
      }
      right = step.factors().solve(right);
      for (std::size_t i = 0; i < stages; ++i) k_[i][part] = right.segment(static_cast<Eigen::Index>(i) * n_, n_);
    }
    stage_points(step, part);
  }
  Parts end = x;
  for (std::size_t part = 0; part < parts; ++part)
    for (std::size_t j = 0; j < stages; ++j)
      for (std::size_t r = 0; r <= part; ++r)
        if ((r & part) == r) end[part] += (step.b[j] * h[part ^ r]) * k_[j][r];
  x = end;
}

}  // namespace whirl::models
