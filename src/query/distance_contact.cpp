// SPDX-License-Identifier: BSD-3-Clause
#include "query/distance_contact.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <utility>

#include "elementary/ordered_points.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

/// The origin of the boxes of a mesh.
double originOf(const MeshInstance& mesh, int frame, int k) {
  return mesh.translation[frame][k] +
         (mesh.tree ? mesh.tree->origin(frame)[k] : mesh.rigid.origin(frame)[k]);
}

/// Bound on the difference of a coordinate of two vertices, without rounding.
double sizeOf(const MeshInstance& a, const MeshInstance& b) {
  double size = 0;
  for (int frame = 0; frame < 2; ++frame)
    for (int k = 0; k < 3; ++k)
      size = std::max(size, std::abs(originOf(a, frame, k) - originOf(b, frame, k)));
  for (const MeshInstance* mesh : {&a, &b})
    size +=
        mesh->tree ? mesh->tree->largestCoordinate() : mesh->rigid.largestCoordinate();
  return size;
}

/// Bound on the way along an axis that a point of a mesh moves during the step.
double displacementOf(const MeshInstance& mesh) {
  if (!mesh.tree) return std::numeric_limits<double>::infinity();
  const MovingKdopNode& root = mesh.tree->node(0);
  float most = 0;
  for (int lane = 0; lane < root.count; ++lane)
    most = std::max(most, root.displacement[lane]);
  return most + mesh.poseDisplacement();
}

/// setPart() for each answer that Kernels::approach() may have: most of the contacts of
/// a query have one.
class PartTable {
 public:
  PartTable() {
    for (const bool is_edges : {false, true})
      for (unsigned exchanges = 0; exchanges < kExchanges; ++exchanges)
        for (int part = 0; part <= Approach::kInside; ++part) {
          const ContinuousContactKind kind = is_edges
                                                 ? ContinuousContactKind::kEdgeEdge
                                                 : ContinuousContactKind::kVertexFace;
          // A triangle has three sides and corners.
          if (!is_edges && part % Approach::kCorner == 3) continue;
          NearestPoint near;
          if (part < Approach::kCorner)
            near.side = part;
          else if (part < Approach::kInside)
            near.corner = part - Approach::kCorner;
          int number[4];
          exchangedNumbers(kind, exchanges, number);
          DistanceContact& contact = contacts_[is_edges][exchanges][part];
          contact.is_contact = true;
          setPart(kind, near, number, contact);
        }
  }

  const DistanceContact& find(ContinuousContactKind kind, const Approach& found) const {
    assert(found.exchanges < kExchanges && found.part <= Approach::kInside);
    const DistanceContact& contact =
        contacts_[kind == ContinuousContactKind::kEdgeEdge][found.exchanges][found.part];
    assert(contact.is_contact);
    return contact;
  }

 private:
  static constexpr unsigned kExchanges = 8;

  DistanceContact contacts_[2][kExchanges][Approach::kInside + 1];
};

}  // namespace

double cullDistanceOf(const MeshInstance& a, const MeshInstance& b, double d) {
  assert(d > 0);
  // The tolerance of a pair is kTouching (d + L), with L at most the length of a vector
  // of three such coordinates, below twice their size. The rest is more than the rounding
  // of this.
  const double cull_distance = d * (1 + 2 * DistanceTolerance::kShare) +
                               2 * DistanceTolerance::kTouching * (d + 2 * sizeOf(a, b));
  assert(cull_distance >= d);
  return cull_distance;
}

void enlarge(double cull_distance, KdopShift& shift) {
  // The first three directions are axes, the others have the length sqrt(2).
  constexpr double kDiagonal = 1.4142135623730952;
  assert(cull_distance >= 0);
  for (int j = 0; j < 16; ++j)
    for (Kdop16* box : {&shift.t0, &shift.t1}) {
      const float before = box->half[j];
      box->half[j] = roundUp(
          double{before} + (j % 8 < 3 ? cull_distance : kDiagonal * cull_distance), 0.f);
      assert(!(box->half[j] < before));
    }
}

BoxShifts::BoxShifts(const KdopShift* between) : is_empty_(!between) {
  if (between) between_ = *between;
}

BoxShifts::BoxShifts(const MeshInstance& a, const MeshInstance& b,
                     const KdopShift* between, double distance,
                     bool ignores_initially_closer)
    : BoxShifts(between) {
  if (!(distance > 0)) return;
  is_empty_ = false;
  cull_distance_ = cullDistanceOf(a, b, distance);
  const double size = sizeOf(a, b);
  // For pairs beyond d: the rounding of two distances, 256 u L, is below the eighth of
  // kShare d. Here L is the length of a vector of three coordinates of this size.
  if (!ignores_initially_closer || !(distance > 0x1p-11 * size)) return;
  // Kernels::mayComeWithin() leaves pairs within half of this to the test. What the test
  // takes for touching is much nearer.
  almost_ = 2 * DistanceTolerance::kAlmost * std::max(distance, size);
  assert(almost_ < cull_distance_);
  // Two points come nearer by at most the root of 3 of what they move along an axis. A
  // pair at a distance D below d has to come nearer by kShare D and by what counts as
  // touching, which is more than the rounding; one that is further apart by kShare d:
  // advanceToDistance().
  speed_ = 2 / DistanceTolerance::kShare * (displacementOf(a) + displacementOf(b));
  assert(speed_ >= 0);
}

void BoxShifts::leaveOutStart() {
  assert(!(speed_ < std::numeric_limits<double>::infinity()));
  // shifted() keeps a half-axis at kLeastHalf or above, so that the sum of two boxes is
  // finite or plus infinity, where nothing of a window is cut off.
  for (float& half : between_.t0.half) half = 0.5f * kLeastHalf;
}

double BoxShifts::cullDistance(double latest) const {
  assert(0 <= latest && latest <= 1);
  const double share = speed_ * latest;
  return share < cull_distance_ ? std::min(cull_distance_, std::max(almost_, share))
                                : cull_distance_;
}

KdopShift BoxShifts::shift(double cull_distance) const {
  KdopShift shift = between_;
  if (cull_distance > 0) enlarge(cull_distance, shift);
  return shift;
}

FeatureContact contactOf(const FeatureIds& pair, const DistanceContact& found,
                         bool is_self) {
  constexpr std::uint32_t kUnused = std::numeric_limits<std::uint32_t>::max();
  assert(found.is_contact && (!is_self || pair.first_on_a));
  FeatureContact contact{pair, found.toc_lo, found.toc_hi};
  contact.kind = found.kind;
  if (!isPart(found.kind)) return contact;
  const int num_first = pair.kind == ContinuousContactKind::kEdgeEdge ? 2 : 1;
  for (int i = 0; i < 4; ++i) {
    assert(found.points[i] < 4);
    contact.vertices[i] = found.points[i] < 0 ? kUnused : pair.vertices[found.points[i]];
  }
  assert(found.points[0] >= 0 && found.points[1] >= 0);
  bool is_first = found.points[0] < num_first;
  if (found.kind == ContinuousContactKind::kVertexEdge) {
    if (contact.vertices[2] < contact.vertices[1])
      std::swap(contact.vertices[1], contact.vertices[2]);
    contact.first_on_a = is_first == pair.first_on_a;
    if (!is_self || contact.first_on_a) return contact;
  } else {
    const bool is_exchanged =
        is_self ? contact.vertices[1] < contact.vertices[0] : is_first != pair.first_on_a;
    if (is_exchanged) {
      std::swap(contact.vertices[0], contact.vertices[1]);
      is_first = !is_first;
    }
    contact.first_on_a = is_first == pair.first_on_a;
    if (contact.first_on_a) return contact;
  }
  contact.first_on_a = true;
  std::swap(contact.triangles[0], contact.triangles[1]);
  return contact;
}

PointIds idsOf(const FeatureIds& pair) {
  PointIds out;
  std::copy(pair.vertices, pair.vertices + 4, out.id);
  return out;
}

DistanceContact contactOf(ContinuousContactKind kind, const Approach& found) {
  assert(found.answer == Approach::Answer::kYes);
  static const PartTable table;
  DistanceContact contact = table.find(kind, found);
  contact.toc_lo = found.toc_lo;
  contact.toc_hi = found.toc_hi;
  return contact;
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl
