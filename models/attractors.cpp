#include "models/attractors.hpp"

#include <algorithm>

namespace whirl::models {
namespace {

// Share of b's points that lie on a's cloud.
double overlap(const Attractor& a, const Attractor& b) {
  const Capture cloud(a);
  Eigen::Index inside = 0;
  for (Eigen::Index j = 0; j < b.points.cols(); ++j) inside += cloud.near(b.points.col(j)) ? 1 : 0;
  return static_cast<double>(inside) / static_cast<double>(b.points.cols());
}

}  // namespace

bool same_motion(const Attractor& a, const Attractor& b) {
  if (a.kind != b.kind || a.multiple != b.multiple || a.points.rows() != b.points.rows()) return false;
  if (a.kind != MotionKind::periodic) return overlap(a, b) > 0.8 && overlap(b, a) > 0.8;
  const Vector x = b.points.col(0);
  return (a.points.colwise() - x).colwise().norm().minCoeff() < 1e-6 * (1.0 + x.norm());  // points are known to about 1e-10
}

Attractor reflected(const Attractor& a, const Vector& signs) {
  Attractor b = a;
  b.points = signs.asDiagonal() * a.points;
  return b;
}

int AttractorSet::find(const Attractor& attractor) const {
  for (int i = 0; i < size(); ++i)
    if (same_motion((*this)[i], attractor)) return i;
  return -1;
}

int AttractorSet::add(Attractor attractor, const Capture& capture) {
  if (const int known = find(attractor); known >= 0) return known;
  const int index = size();
  attractor.symmetries.clear();
  attractor.mirror_of = -1;
  std::vector<std::pair<Attractor, Capture>> images;
  for (const auto& r : reflections_) {
    Attractor image = reflected(attractor, r.signs);
    if (same_motion(attractor, image)) {
      attractor.symmetries.push_back(r.subtype);
      continue;
    }
    const bool listed = std::any_of(images.begin(), images.end(), [&](const auto& other) { return same_motion(other.first, image); });
    if (listed) continue;
    image.mirror_of = index;
    image.mirror = r.subtype;
    images.emplace_back(std::move(image), capture.reflected(r.signs));
  }
  if (!images.empty()) {
    attractor.mirror_of = index + 1;
    attractor.mirror = images.front().first.mirror;
  }
  attractors_.push_back(std::move(attractor));
  captures_.push_back(capture);
  for (auto& [image, its] : images) {
    image.symmetries = attractors_[static_cast<std::size_t>(index)].symmetries;
    attractors_.push_back(std::move(image));
    captures_.push_back(std::move(its));
  }
  return index;
}

int AttractorSet::image(int i, std::size_t r) const { return find(reflected((*this)[i], reflections_[r].signs)); }

}  // namespace whirl::models
