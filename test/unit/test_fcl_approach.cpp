// SPDX-License-Identifier: BSD-3-Clause
//
// Pairs that are nearer than min_distance at t = 0 and are ignored then: contacts only of
// what comes nearer, against distances in Real at many times.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "elementary/accurate_nearest.h"
#include "elementary/distance_advance.h"
#include "elementary/following_direction.h"
#include "fcl/geometry/bvh/deformable_bvh_model.h"
#include "fcl/geometry/shape/box.h"
#include "fcl/math/bv/OBBRSS.h"
#include "fcl/narrowphase/continuous_collision.h"
#include "fcl/narrowphase/continuous_features.h"
#include "moving_mesh.h"
#include "real.h"
#include "sanitizer.h"
#include "test_models.h"

namespace fcl {
namespace test {
namespace {

using detail::deformable::accurateNearest;
using detail::deformable::AccurateNearest;
using detail::deformable::advanceToDistance;
using detail::deformable::DifferencePolygon;
using detail::deformable::DistanceContact;
using detail::deformable::DistanceTolerance;
using detail::deformable::FeaturePoints;
using detail::deformable::followingStep;
using detail::deformable::kUnit;
using detail::deformable::lowestAlong;
using detail::deformable::Vec;
using detail::deformable::VertexPath;
using Request = detail::deformable::DistanceRequest;
using Kind = ContinuousContactKind;
template <typename S>
using ModelOf = DeformableBVHModel<OBBRSS<S>>;

/// Of a point and a segment.
Real distanceOf(const RealVector& x, const RealVector& from, const RealVector& to) {
  const RealVector way = to - from;
  const Real square = way.squaredNorm(), along = square > 0 ? way.dot(x - from) : 0;
  const Real share =
      square > 0 ? std::min(std::max(along / square, Real(0)), Real(1)) : 0;
  return (x - (from + share * way)).norm();
}

/// Of two features, as the distance of two points of them: where rounding hides which
/// points are nearest it is too large, never too small.
Real distanceAt(Kind kind, const FeaturePoints& x, Real t) {
  RealVector p[4];
  for (int i = 0; i < 4 && x.point[i]; ++i)
    for (int k = 0; k < 3; ++k) p[i][k] = (1 - t) * x[i].t0[k] + t * x[i].t1[k];
  if (kind == Kind::kVertexVertex) return (p[1] - p[0]).norm();
  if (kind == Kind::kVertexEdge) return distanceOf(p[0], p[1], p[2]);
  const bool is_face = kind == Kind::kVertexFace;
  const Real best =
      is_face ? std::min({distanceOf(p[0], p[1], p[2]), distanceOf(p[0], p[2], p[3]),
                          distanceOf(p[0], p[3], p[1])})
              : std::min({distanceOf(p[0], p[2], p[3]), distanceOf(p[1], p[2], p[3]),
                          distanceOf(p[2], p[0], p[1]), distanceOf(p[3], p[0], p[1])});
  // The points w + along u + across v, and of these the nearest one to the origin.
  const RealVector u = is_face ? p[2] - p[1] : p[0] - p[1],
                   v = is_face ? p[3] - p[1] : p[3] - p[2],
                   w = is_face ? p[1] - p[0] : p[2] - p[0], n = u.cross(v);
  const Real square = n.squaredNorm();
  if (!(square > 0)) return best;
  const Real along = v.cross(w).dot(n) / square, across = w.cross(u).dot(n) / square;
  const bool is_inside =
      along > 0 && across > 0 && (is_face ? along + across < 1 : along < 1 && across < 1);
  return is_inside ? std::min(best, (w + along * u + across * v).norm()) : best;
}

/// What approaches of single pairs were seen.
struct Seen {
  int contacts{0}, ignored{0};
};

/// Checks the answer for a pair that is ignored while it does not come nearer.
/// @param share  by which a pair has to come nearer, at most: twice what the library says
void expectApproach(Kind kind, const FeaturePoints& x, const Request& request,
                    Seen& seen) {
  constexpr int kSamples = 40;
  constexpr double kShare = 4 * DistanceTolerance::kShare;
  const DistanceContact found = advanceToDistance(kind, x, request);
  EXPECT_FALSE(found.is_given_up);
  const Real start = distanceAt(kind, x, 0);
  const double size = DifferencePolygon(kind, x).size(),
               rounding = 4 * DistanceTolerance::kTouching * (request.distance + size);
  if (start <= rounding) return;  // they touch
  if (start > request.distance) return;
  if (found.is_contact) {
    ++seen.contacts;
    EXPECT_GT(found.toc_lo, 0);
    EXPECT_LT(distanceAt(kind, x, found.toc_lo), start);
  }
  // Many times early in the step, where the first contact matters most.
  const Real least = start * (1 - kShare) - rounding;
  for (int i = 0; i < kSamples; ++i) {
    const Real t = i < 30 ? Real(i + 1) / 30 : ldexp(Real(1), 4 * (29 - i));
    if (!(distanceAt(kind, x, t) < least)) continue;
    EXPECT_TRUE(found.is_contact && found.toc_lo <= t);
  }
  seen.ignored += !found.is_contact;
}

struct Layers {
  MovingMesh lower, upper;

  /// Two layers of quads of side 1/4 above each other, whose vertices move a little.
  Layers(std::uint64_t seed, double height) {
    Random random(seed);
    lower = still(makeSheet(4, 4));
    upper = lower;
    for (auto& p : upper.t0) p[2] = height;
    // About a normal distribution.
    const auto little = [&random] {
      double sum = 0;
      for (int i = 0; i < 12; ++i) sum += random.uniform(-0.5, 0.5);
      return 0.002 * sum;
    };
    for (MovingMesh* mesh : {&lower, &upper})
      for (std::size_t i = 0; i < mesh->t0.size(); ++i)
        mesh->t1[i] = mesh->t0[i] + Vector3<double>(little(), little(), little());
  }
};

template <typename S>
std::shared_ptr<ModelOf<S>> modelOf(const MovingMesh& mesh) {
  return makeModel<ModelOf<S>>(TestMesh{mesh.t0, mesh.triangles},
                               TestMesh{mesh.t1, mesh.triangles});
}

/// The vertices of a contact.
template <typename S>
struct ContactPaths {
  VertexPath path[4];
  FeaturePoints points{{nullptr, nullptr, nullptr, nullptr}};

  ContactPaths(const ContinuousContact<S>& c, const MovingMesh& o1,
               const MovingMesh& o2) {
    const int num_first = c.kind == Kind::kEdgeEdge ? 2 : 1;
    for (int i = 0; i < c.numVertices(); ++i) {
      const MovingMesh& mesh = (i < num_first) == c.first_on_o1 ? o1 : o2;
      const auto id = static_cast<std::size_t>(c.vertices[static_cast<std::size_t>(i)]);
      for (int k = 0; k < 3; ++k) {
        path[i].t0[k] = static_cast<S>(mesh.t0[id][k]);
        path[i].t1[k] = static_cast<S>(mesh.t1[id][k]);
      }
      points.point[i] = &path[i];
    }
  }
};

/// @return whether there are contacts
template <typename S>
bool expectLayersApproach(const Layers& layers, bool is_self) {
  ContinuousContactRequest<S> request;
  request.toc_err = S(1e-6);
  request.min_distance = S(0.5);
  request.ignore_initially_closer = true;
  const auto lower = modelOf<S>(layers.lower), upper = modelOf<S>(layers.upper);
  MovingMesh both = layers.lower;
  append(both, layers.upper);
  const auto whole = modelOf<S>(both);
  const auto ask = [&] {
    return is_self ? selfContacts<S>(*whole, request)
                   : pairContacts<S>(*lower, *upper, request);
  };
  const auto all = ask();
  for (const auto& c : all.contacts) {
    const ContactPaths<S> x(c, is_self ? both : layers.lower,
                            is_self ? both : layers.upper);
    EXPECT_LT(distanceAt(c.kind, x.points, c.toc_lo), distanceAt(c.kind, x.points, 0));
  }
  request.query = ContinuousQuery::kFirst;
  const auto first = ask();
  EXPECT_EQ(first.contacts.empty(), all.contacts.empty());
  if (all.contacts.empty()) return false;
  EXPECT_EQ(first.contacts.front().toc_lo, all.contacts.front().toc_lo);
  request.query = ContinuousQuery::kAny;
  EXPECT_EQ(ask().contacts.size(), 1U);
  return true;
}

/// Ends above ends and edges that are nearly parallel, where rounding hides which points
/// are nearest.
TEST(FCL_APPROACH, alignedLayers) {
  int hits = 0;
  for (std::uint64_t seed = 0; seed < rounds(120U); ++seed) {
    SCOPED_TRACE(seed);
    hits += expectLayersApproach<double>(Layers(seed, 0.0703), seed % 2 == 1);
  }
  EXPECT_EQ(hits, rounds(120));
}

TEST(FCL_APPROACH, alignedLayersInFloat) {
  for (std::uint64_t seed = 0; seed < rounds(20U); ++seed) {
    SCOPED_TRACE(seed);
    expectLayersApproach<float>(Layers(seed, 0.0703125), seed % 2 == 1);
  }
}

TEST(FCL_APPROACH, allPairsOfAlignedLayers) {
  Seen seen;
  Request request;
  request.distance = 0.5;
  request.toc_err = 1e-6;
  request.ignores_initially_closer = true;
  for (std::uint64_t seed = 0; seed < rounds(60U); ++seed) {
    SCOPED_TRACE(seed);
    const Layers layers(seed, 0.0703);
    const auto pathOf = [](const MovingMesh& mesh, std::size_t id) {
      VertexPath x;
      for (int k = 0; k < 3; ++k) {
        x.t0[k] = mesh.t0[id][k];
        x.t1[k] = mesh.t1[id][k];
      }
      return x;
    };
    for (std::size_t i = 0; i < layers.lower.triangles.size(); ++i)
      for (std::size_t j = 0; j < layers.upper.triangles.size(); j += 1 + seed % 3) {
        const int k = static_cast<int>((i + j) % 3), l = static_cast<int>((i + seed) % 3);
        const VertexPath x[] = {pathOf(layers.lower, layers.lower.id(i, k)),
                                pathOf(layers.lower, layers.lower.id(i, (k + 1) % 3)),
                                pathOf(layers.upper, layers.upper.id(j, l)),
                                pathOf(layers.upper, layers.upper.id(j, (l + 1) % 3)),
                                pathOf(layers.upper, layers.upper.id(j, (l + 2) % 3))};
        expectApproach(Kind::kEdgeEdge, {{&x[0], &x[1], &x[2], &x[3]}}, request, seen);
        expectApproach(Kind::kVertexFace, {{&x[0], &x[2], &x[3], &x[4]}}, request, seen);
        expectApproach(Kind::kVertexEdge, {{&x[0], &x[2], &x[3], nullptr}}, request,
                       seen);
        expectApproach(Kind::kVertexVertex, {{&x[0], &x[2], nullptr, nullptr}}, request,
                       seen);
      }
  }
  EXPECT_GT(seen.contacts, rounds(10000));
  EXPECT_GT(seen.ignored, rounds(10000));
}

/// Points of features on a grid, so that many are aligned, parallel or end above end,
/// with motions of all sizes.
TEST(FCL_APPROACH, alignedPairsOfAllSizes) {
  Random random(711);
  Seen seen;
  for (int i = 0; i < rounds(40000); ++i) {
    SCOPED_TRACE(i);
    const double size = std::ldexp(1, static_cast<int>(random.index(120)) - 60),
                 motion = size * std::pow(10, -random.uniform(0, 12)),
                 height = size * std::pow(10, -random.uniform(0, 4));
    const Kind kind =
        std::array<Kind, 4>{Kind::kVertexFace, Kind::kEdgeEdge, Kind::kVertexEdge,
                            Kind::kVertexVertex}[random.index(4)];
    const Vector3<double> together =
        random.index(3) ? random.point(0.) : random.point(size);
    const int num_first = kind == Kind::kEdgeEdge ? 2 : 1;
    VertexPath x[4];
    FeaturePoints points{{&x[0], &x[1], &x[2], &x[3]}};
    if (kind == Kind::kVertexEdge || kind == Kind::kVertexVertex)
      points.point[3] = nullptr;
    if (kind == Kind::kVertexVertex) points.point[2] = nullptr;
    const bool slides = random.index(8) == 0;
    for (int v = 0; v < 4; ++v) {
      const double place[] = {0.25 * size * static_cast<double>(random.index(4)),
                              0.25 * size * static_cast<double>(random.index(3)),
                              v < num_first ? 0 : height};
      const Vector3<double> by = together + random.point(motion);
      for (int k = 0; k < 3; ++k) {
        x[v].t0[k] = place[k];
        x[v].t1[k] = place[k] + (slides && k == 2 ? 0 : by[k]);
      }
    }
    Request request;
    request.distance = size * std::pow(10, random.uniform(-3, 1));
    request.toc_err = 1e-6;
    request.ignores_initially_closer = true;
    expectApproach(kind, points, request, seen);
    if (HasFailure()) return;
  }
  EXPECT_GT(seen.contacts, rounds(5000));
  EXPECT_GT(seen.ignored, rounds(5000));
}

/// Distances that are constant, or that of the request.
TEST(FCL_APPROACH, pairsThatKeepTheirDistance) {
  Random random(712);
  for (int i = 0; i < rounds(4000); ++i) {
    SCOPED_TRACE(i);
    const bool is_edges = random.index(2) == 0;
    const Kind kind = is_edges ? Kind::kEdgeEdge : Kind::kVertexFace;
    // Features in two planes with the distance 1, which stay in them.
    VertexPath x[4];
    for (int v = 0; v < 4; ++v) {
      const Vector3<double> from = random.point(2), to = random.point(2);
      for (int k = 0; k < 3; ++k) {
        const bool is_second = v >= (is_edges ? 2 : 1);
        x[v].t0[k] = k == 2 ? is_second : from[k];
        x[v].t1[k] = k == 2 ? is_second : random.index(4) ? to[k] : from[k];
      }
    }
    const FeaturePoints points{{&x[0], &x[1], &x[2], &x[3]}};
    Request request;
    request.distance = i % 2 ? 1 : 1 + random.uniform(0, 1);
    request.ignores_initially_closer = true;
    const DistanceContact found = advanceToDistance(kind, points, request);
    EXPECT_FALSE(found.is_given_up);
    if (distanceAt(kind, points, 0) <= 1) {
      EXPECT_FALSE(found.is_contact);
    }
    // At rest nothing comes nearer.
    for (VertexPath& v : x) std::copy(v.t0, v.t0 + 3, v.t1);
    EXPECT_FALSE(advanceToDistance(kind, points, request).is_contact &&
                 distanceAt(kind, points, 0) <= request.distance);
  }
}

/// Features of very different sizes: no pair is given up, and the list is that of the
/// public tests of all pairs.
TEST(FCL_APPROACH, mixedSizesAgainstElementaryTests) {
  Random random(713);
  int vf = 0, ee = 0;
  for (int i = 0; i < rounds(60); ++i) {
    SCOPED_TRACE(i);
    MovingMesh mesh[2];
    for (MovingMesh& m : mesh) {
      for (int v = 0; v < 12; ++v) {
        const double size = std::pow(10, static_cast<double>(random.index(19)) - 9);
        m.t0.push_back(random.point(size));
        m.t1.push_back(random.index(3) ? m.t0.back() + random.point(1e-3 * size)
                                       : random.point(size));
      }
      for (std::size_t v = 0; v < 12; v += 3) m.triangles.emplace_back(v, v + 1, v + 2);
    }
    const auto o1 = modelOf<double>(mesh[0]), o2 = modelOf<double>(mesh[1]);
    ContinuousContactRequest<double> request;
    request.toc_err = 1e-6;
    request.min_distance = std::pow(10, static_cast<double>(random.index(13)) - 9);
    const auto result = pairContacts<double>(*o1, *o2, request);
    for (const auto& c : result.contacts) {
      const ContactPaths<double> x(c, mesh[0], mesh[1]);
      if (c.kind != Kind::kVertexFace && c.kind != Kind::kEdgeEdge) continue;
      const auto at = [&](int v, bool is_end) {
        const auto& p = is_end ? x.path[v].t1 : x.path[v].t0;
        return Vector3<double>(p[0], p[1], p[2]);
      };
      const auto alone =
          (c.kind == Kind::kVertexFace
               ? vertexFaceWithin<double>
               : edgeEdgeWithin<double>)(at(0, false), at(1, false), at(2, false),
                                         at(3, false), at(0, true), at(1, true),
                                         at(2, true), at(3, true), 1e-6,
                                         request.min_distance);
      EXPECT_TRUE(alone.is_contact);
      EXPECT_EQ(alone.toc_lo, c.toc_lo);
      EXPECT_EQ(alone.toc_hi, c.toc_hi);
      ++(c.kind == Kind::kVertexFace ? vf : ee);
    }
  }
  EXPECT_GT(vf, rounds(100));
  EXPECT_GT(ee, rounds(100));
}

/// A gripper and what it holds turn together on a screw. All distances stay the same; a
/// little more turn of one of them brings it nearer.
TEST(FCL_APPROACH, bodiesThatMoveAsOne) {
  using RigidModel = BVHModel<OBBRSS<double>>;
  const auto box = makeModel<RigidModel>(makeBox(Vector3<double>(0.05, 0.05, 0.05), 2));
  const Box<double> shape(0.1, 0.1, 0.1);
  const auto turn = [](double angle) {
    Transform3<double> out = Transform3<double>::Identity();
    out.linear() = AngleAxis<double>(angle, Vector3<double>(0, 0, 1)).toRotationMatrix();
    return out;
  };
  ContinuousContactRequest<double> request;
  request.ccd_motion_type = CCDM_SCREW;
  request.min_distance = 0.01;
  request.ignore_initially_closer = true;
  for (const double angle : {0.1, 1., 2., 3.})
    for (const double tilt : {0., 0.02})
      for (const CollisionGeometry<double>* held :
           {static_cast<const CollisionGeometry<double>*>(box.get()),
            static_cast<const CollisionGeometry<double>*>(&shape)}) {
        SCOPED_TRACE(std::to_string(angle) + ", " + std::to_string(tilt));
        Transform3<double> tf1 = Transform3<double>::Identity(), tf2 = turn(tilt);
        tf1.translation() = Vector3<double>(1, 0, 0);
        tf2.translation() = Vector3<double>(1, 0.104, 0);
        ContinuousContactResult<double> result;
        const auto ask = [&](double more) {
          continuousCollide(box.get(), tf1, turn(angle + more) * tf1, held, tf2,
                            turn(angle) * tf2, request, result);
          return result.contacts.size();
        };
        EXPECT_EQ(ask(0), 0U);
        EXPECT_GT(ask(0.003), 0U);
        EXPECT_GT(result.time_of_contact, 0);
      }
}

/// The direction of the nearest point, for slivers and polygons of mixed sizes, and how
/// long it is one.
TEST(FCL_APPROACH, accurateDirections) {
  Random random(714);
  int steps = 0, long_steps = 0;
  for (int i = 0; i < rounds(20000); ++i) {
    SCOPED_TRACE(i);
    const Kind kind = random.index(2) ? Kind::kEdgeEdge : Kind::kVertexFace;
    VertexPath x[4];
    for (int v = 0; v < 4; ++v) {
      const double size = std::pow(10, random.uniform(-6, 6));
      const Vector3<double> from = random.point(size), by = random.point(size);
      for (int k = 0; k < 3; ++k) {
        x[v].t0[k] = from[k];
        x[v].t1[k] = from[k] + by[k];
      }
    }
    if (random.index(2))  // nearly parallel
      for (int k = 0; k < 3; ++k)
        x[3].t0[k] = x[2].t0[k] + 0.7 * (x[1].t0[k] - x[0].t0[k]) * (1 + 1e-9 * k);
    const FeaturePoints points{{&x[0], &x[1], &x[2], &x[3]}};
    const DifferencePolygon polygon(kind, points);
    Vec corners[4], velocities[4];
    for (int k = 0; k < polygon.count(); ++k) {
      corners[k] = polygon.t0(k);
      velocities[k] = polygon.t1(k) - polygon.t0(k);
    }
    const AccurateNearest nearest = accurateNearest(polygon, corners);
    const double distance = static_cast<double>(distanceAt(kind, points, 0)),
                 rounding = 64 * kUnit * polygon.size();
    EXPECT_LE(nearest.near.distance, distance + rounding);
    if (!(nearest.near.distance > 0)) continue;
    EXPECT_NEAR(lowestAlong(nearest.direction, corners, polygon.count()),
                nearest.near.distance, rounding);
    const double d = random.uniform(0, 1) * nearest.near.distance,
                 least = d + 128 * kUnit * (d + polygon.size()),
                 step = followingStep(polygon, corners, velocities, nearest,
                                      polygon.size(), least, 1);
    EXPECT_TRUE(0 <= step && step <= 1);
    for (int s = 1; s <= 8; ++s)
      EXPECT_GT(distanceAt(kind, points, Real(step) * s / 8), d);
    steps += step > 0;
    long_steps += step > 1e-3;
    if (HasFailure()) return;
  }
  EXPECT_GT(steps, rounds(10000));
  EXPECT_GT(long_steps, rounds(3000));
}

}  // namespace
}  // namespace test
}  // namespace fcl
