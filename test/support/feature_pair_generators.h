// SPDX-License-Identifier: BSD-3-Clause
//
// Random VF and EE pairs for tests of the elementary test and its stages.
#ifndef FCL_TEST_SUPPORT_FEATURE_PAIR_GENERATORS_H
#define FCL_TEST_SUPPORT_FEATURE_PAIR_GENERATORS_H

#include <array>
#include <cmath>
#include <cstddef>
#include <ostream>

#include "elementary/elementary.h"
#include "mesh_generators.h"

namespace fcl {
namespace test {

/// @brief A VF or EE pair that owns its points.
struct MovingPair {
  fcl::ContinuousContactKind kind;
  std::array<detail::deformable::VertexPath, 4> x;

  detail::deformable::FeaturePoints points() const {
    return {{&x[0], &x[1], &x[2], &x[3]}};
  }
};

/// @brief A point that does not move.
inline detail::deformable::VertexPath at(double x, double y, double z) {
  return {{x, y, z}, {x, y, z}};
}
/// @brief A point that moves from z = z0 to z = z1.
inline detail::deformable::VertexPath falling(double x, double y, double z0, double z1) {
  return {{x, y, z0}, {x, y, z1}};
}
inline detail::deformable::VertexPath path(const double (&a)[3], const double (&b)[3]) {
  return {{a[0], a[1], a[2]}, {b[0], b[1], b[2]}};
}
/// @brief A vertex and a triangle at rest, (0, 0, 0), (4, 0, 0), (0, 4, 0).
inline MovingPair onTriangle(const detail::deformable::VertexPath& v) {
  return {fcl::ContinuousContactKind::kVertexFace,
          {v, at(0, 0, 0), at(4, 0, 0), at(0, 4, 0)}};
}

/// @brief The coordinates with every bit, to repeat a failure.
inline std::ostream& operator<<(std::ostream& out, const MovingPair& pair) {
  out << (pair.kind == fcl::ContinuousContactKind::kVertexFace ? "VF" : "EE")
      << std::hexfloat;
  for (const auto& p : pair.x)
    out << "\n  {{" << p.t0[0] << ", " << p.t0[1] << ", " << p.t0[2] << "}, {" << p.t1[0]
        << ", " << p.t1[1] << ", " << p.t1[2] << "}}";
  return out << std::defaultfloat;
}

inline fcl::ContinuousContactKind randomKind(Random& random) {
  return random.index(2) ? fcl::ContinuousContactKind::kVertexFace
                         : fcl::ContinuousContactKind::kEdgeEdge;
}

/// @brief Integer coordinates in [-half, half]; in every second pair one coordinate does
/// not move or is the same for all points.
inline MovingPair gridPair(Random& random, int half) {
  MovingPair pair{randomKind(random), {}};
  const auto coordinate = [&] {
    return static_cast<double>(random.index(static_cast<std::size_t>(2 * half + 1))) -
           half;
  };
  for (auto& p : pair.x)
    for (int k = 0; k < 3; ++k) {
      p.t0[k] = coordinate();
      p.t1[k] = coordinate();
    }
  const std::size_t special = random.index(4), axis = random.index(3);
  for (auto& p : pair.x) {
    if (special == 1) p.t1[axis] = p.t0[axis];
    if (special == 2) p.t0[axis] = p.t1[axis] = 1;
  }
  return pair;
}

/// @brief Two features that touch, up to rounding and `gap`, at a time that the function
/// chooses. They often touch at a border of a feature.
inline MovingPair nearContactPair(Random& random, double gap) {
  using fcl::ContinuousContactKind;
  MovingPair pair{randomKind(random), {}};
  Vector3<double> p[4];
  for (auto& point : p) point = random.point(1);
  const auto weight = [&random] {
    const double corners[] = {0, 1, 1e-17, 1 - 1e-16, 0.5};
    const std::size_t i = random.index(10);
    return i < 5 ? corners[i] : random.uniform(0, 1);
  };
  const double r = weight(), s = weight();
  Vector3<double> normal;
  if (pair.kind == ContinuousContactKind::kVertexFace) {
    p[0] = (1 - r) * p[1] + r * ((1 - s) * p[2] + s * p[3]);
    normal = (p[2] - p[1]).cross(p[3] - p[1]);
  } else {
    const Vector3<double> move =
        ((1 - r) * p[0] + r * p[1]) - ((1 - s) * p[2] + s * p[3]);
    p[2] += move;
    p[3] += move;
    normal = (p[1] - p[0]).cross(p[3] - p[2]);
  }
  const double length = normal.norm();
  if (length > 0) p[0] += gap / length * normal;
  const double times[] = {0, 1, 0.5, 1e-9, 1 - 1e-9};
  const std::size_t which = random.index(10);
  const double t = which < 5 ? times[which] : random.uniform(0, 1);
  const double speed = random.index(8) ? std::pow(10, random.uniform(-6, 0.5)) : 0;
  for (std::size_t i = 0; i < 4; ++i) {
    const Vector3<double> velocity = speed * random.point(1);
    for (int k = 0; k < 3; ++k) {
      pair.x[i].t0[k] = p[i][k] - t * velocity[k];
      pair.x[i].t1[k] = p[i][k] + (1 - t) * velocity[k];
    }
  }
  return pair;
}

/// @brief nearContactPair() with gaps from zero to large.
inline MovingPair randomPair(Random& random) {
  const double gaps[] = {0, 1e-17, 1e-15, 1e-12, 1e-8, 1e-4, 0.1, 1};
  return nearContactPair(random, gaps[random.index(8)]);
}

/// @brief The pair with f applied to every coordinate.
template <typename F>
MovingPair mapped(const MovingPair& pair, F&& f) {
  MovingPair out = pair;
  for (auto& p : out.x)
    for (int k = 0; k < 3; ++k) {
      p.t0[k] = f(p.t0[k]);
      p.t1[k] = f(p.t1[k]);
    }
  return out;
}

/// @brief The pair with its points in another order.
inline MovingPair reordered(const MovingPair& pair,
                            const std::array<std::size_t, 4>& order) {
  MovingPair out = pair;
  for (std::size_t i = 0; i < 4; ++i) out.x[i] = pair.x[order[i]];
  return out;
}

}  // namespace test
}  // namespace fcl

#endif
