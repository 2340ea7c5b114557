// SPDX-License-Identifier: BSD-3-Clause
//
// Regions of a surface that cannot touch themselves: continuous normal cones and the
// contour test of Tang, Curtis, Yoon, Manocha 2009, after Volino and Thalmann 1994.
//
// The proof. Let V be a direction with n(t) . V > 0 for the normal n of every triangle of
// the region and every t. Projected along V all triangles then keep turning the same way,
// and a point of the plane is covered by as many of them as the region's contour winds
// around it. The contour is the sum of the triangles' borders: edges at which they do not
// cancel. If it never touches itself (but where its edges join), it changes without
// changing how often it winds around what it encloses. If that is once at t = 0, no two
// triangles ever cover the same place, so that none of their features can touch but where
// they are joined.
//
// As published, the cones and the crossings of the projected contour are tested, for a
// connected region of a surface that does not touch itself at t = 0. Two things are left
// to that: that the region is in one piece, which a node of a tree built by place need
// not be (of two layers, one above the other, neither contour need cross the other), and
// that it winds once. Both are tested here, by the winding of the contour at t = 0, so
// that nothing is missed whatever state the surface is in, nor is the surface assumed to
// be a manifold. Crossings are tested by conservative conditions on the whole step, not
// by solving for their times.
#ifndef FCL_BENCHMARK_BASELINES_NORMAL_CONES_H
#define FCL_BENCHMARK_BASELINES_NORMAL_CONES_H

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "baselines/candidates.h"
#include "baselines/connectivity.h"
#include "mesh/vertex_frames.h"

namespace fcl {
namespace test {

/// @brief Directions within an angle of a unit axis. All directions if the angle is not
/// below kFull.
struct NormalCone {
  std::array<double, 3> axis;
  double angle;

  /// A right angle less more than what the angles of cones are rounded by.
  static constexpr double kFull = 1.5707963 - 0x1p-16;
  bool isFull() const { return !(angle < kFull); }
};

/// @brief Contains the normal of a moving triangle at every time of the step: those at t
/// = 0 and t = 1 and the middle Bernstein coefficient between them, whose cone contains
/// all their positive combinations. Full if a normal is so short that rounding could turn
/// it.
NormalCone continuousNormalCone(const detail::deformable::VertexPath& a,
                                const detail::deformable::VertexPath& b,
                                const detail::deformable::VertexPath& c);

/// @brief A cone around two, nearly the smallest.
NormalCone merged(const NormalCone& a, const NormalCone& b);

class NormalCones {
 public:
  using VertexPath = detail::deformable::VertexPath;

  /// A region of fewer triangles is not looked at: most of them are adjacent, and what is
  /// left costs less than the contour. Measured on cloth-ball (all of ICCD, ms): 636 with
  /// 1, 634 with 3, 642 with 5, 602 with 9, 602 with 17, 621 without any region; the
  /// larger of the best ones would cost n-body 1% of its pairs of triangles.
  static constexpr std::size_t kLeastTriangles = 9;

  /// @brief Finds the contours. @param regions, mesh  kept by reference
  NormalCones(const Regions& regions, const MeshConnectivity& mesh,
              std::size_t least_triangles = kLeastTriangles);

  /// @brief Cones of all regions. @param paths  of the vertices, kept by reference
  void update(const std::vector<VertexPath>& paths);

  const NormalCone& cone(std::size_t region) const { return cones_[region]; }

  /// @brief Whether it is proved that no two features of the region without a common
  /// vertex touch during the step.
  bool isFreeOfSelfContact(std::size_t region);

 private:
  /// An edge of a contour; its ends are places among the contour's vertices. The region
  /// is on its left, seen against the cone's axis.
  struct ContourEdge {
    std::uint32_t from, to;
  };
  /// Where the contour of a region begins in the arrays below. No edges: too few
  /// triangles or too tangled to be looked at.
  struct Contour {
    std::size_t first_edge, first_vertex, first_seed;
  };
  /// A vertex in the plane at t = 0 and t = 1.
  struct PlanePath {
    double t0[2], t1[2];
  };
  struct DirectedEdge {
    std::uint32_t low, high;
    /// How often the region's triangles run from low to high, less how often they return.
    int turns;
  };
  struct Extent {
    double lo[2], hi[2];
    std::uint32_t edge;
  };

  void addContour(const std::vector<DirectedEdge>& edges);
  void project(std::size_t region);
  bool isContourSimple(std::size_t region);
  bool areApart(const ContourEdge& e, const ContourEdge& f) const;
  bool windsOnce(std::size_t region) const;

  const Regions& regions_;
  const MeshConnectivity& mesh_;
  const std::vector<VertexPath>* paths_{nullptr};
  std::vector<NormalCone> cones_;
  std::vector<Contour> contours_;
  std::vector<ContourEdge> edges_;
  std::vector<std::uint32_t> vertices_;
  /// Edges from which on the contour runs without a branch: what winds once to the left
  /// of each does so along all of it.
  std::vector<std::uint32_t> seeds_;

  /// Of the region that is looked at.
  std::vector<PlanePath> plane_;
  double margin_{0};
  std::vector<Extent> extents_;
};

}  // namespace test
}  // namespace fcl

#endif
