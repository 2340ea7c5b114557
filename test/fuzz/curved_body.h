// SPDX-License-Identifier: BSD-3-Clause
//
// Meshes, shapes and octrees on paths of all kinds, each a second time as convex pieces
// on an exact path in Real.
#ifndef FCL_FUZZ_CURVED_BODY_H
#define FCL_FUZZ_CURVED_BODY_H

#include <array>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "convex_piece.h"
#include "moving_mesh.h"
#include "moving_objects.h"
#include "posed_shape.h"

namespace fcl {
namespace test {

/// @brief A path, and its part of the tolerance of doc/numerics.md.
struct CurvedPath {
  std::shared_ptr<MotionBase<double>> motion;
  std::function<RealPose(Real)> exact;
  /// tau at most, in units of rounding times the size of a pair.
  double tolerance;
  /// Added to the size of the body: of a reference point or an axis far from its origin,
  /// or a velocity.
  double more_size;
  /// As C++.
  std::string code;
  bool is_straight, is_twist;
};

CurvedPath randomPath(Random& random);

struct CurvedBody {
  enum class Kind { kMesh, kShape, kOctree };
  Kind kind;
  MovingMesh mesh;
  PosedShape shape;
  /// Keys of cells of an octree, from its middle.
  std::vector<std::array<int, 3>> cells;
  CurvedPath path;

  std::shared_ptr<CollisionGeometry<double>> geometry;
  std::vector<ConvexPiece> pieces;
  /// Middle and radius of a ball around each piece.
  std::vector<std::pair<RealVector, Real>> balls;

  /// @brief Makes geometry and pieces from what the body is.
  void build();
  /// @brief The piece that b1 or b2 of a contact names.
  std::size_t pieceOf(std::intptr_t b) const;
  PosedPiece at(std::size_t piece, const RealPose& pose, Real t) const {
    return {&pieces[piece], pose.rotation, pose.translation, t};
  }
  /// @brief The body as C++, with a name.
  std::string code(const std::string& name) const;
};

CurvedBody randomMeshBody(Random& random);
CurvedBody randomShapeBody(Random& random, bool with_flats);
CurvedBody randomOctreeBody(Random& random);

}  // namespace test
}  // namespace fcl

#endif
