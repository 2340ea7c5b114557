// SPDX-License-Identifier: BSD-3-Clause
//
// What fcl_ccd adds to FCL, used from an installed package: a sheet bends through a
// resting one, in double and in float.
#include <cstdio>
#include <vector>

#include <fcl/geometry/bvh/deformable_bvh_model.h>
#include <fcl/math/bv/OBBRSS.h>
#include <fcl/narrowphase/continuous_candidates.h>
#include <fcl/narrowphase/continuous_collision.h>
#include <fcl/narrowphase/continuous_feature_test.h>

namespace {

template <typename S>
bool sheetsMeet() {
  using Model = fcl::DeformableBVHModel<fcl::OBBRSS<S>>;
  using Vector = fcl::Vector3<S>;
  const fcl::Transform3<S> still = fcl::Transform3<S>::Identity();

  Model resting;
  resting.beginModel();
  resting.addTriangle(Vector(-4, -4, 0), Vector(4, -4, 0), Vector(0, 4, 0));
  if (resting.endModel() != fcl::BVH_OK) return false;

  // Two triangles that share the edge (0, 1); corner 3 alone moves, and is at height 0
  // after half of the step.
  std::vector<Vector> corners{Vector(0, -1, 1), Vector(0, 1, 1), Vector(-1, 0, 1),
                              Vector(1, 0, 1)};
  Model bending;
  bending.beginModel();
  bending.addSubModel(corners, {fcl::Triangle(0, 1, 2), fcl::Triangle(1, 0, 3)});
  if (bending.endModel() != fcl::BVH_OK) return false;
  corners[3].z() = -1;
  bending.beginUpdateModel();
  bending.updateSubModel(corners);
  if (bending.endUpdateModel() != fcl::BVH_OK) return false;

  fcl::ContinuousCollisionResult<S> first;
  fcl::continuousCollide(&resting, still, still, &bending, still, still,
                         fcl::ContinuousCollisionRequest<S>(), first);
  const bool first_ok = first.is_collide && first.time_of_contact <= S(0.5) &&
                        first.time_of_contact >= S(0.4998);

  fcl::ContinuousContactResult<S> all;
  fcl::continuousCollide(&resting, still, still, &bending, still, still,
                         fcl::ContinuousContactRequest<S>(), all);
  const bool all_ok = all.is_collide && all.contacts.size() == 1 &&
                      all.contacts[0].kind == fcl::ContinuousContactKind::kVertexFace &&
                      all.contacts[0].vertices[0] == 3;

  // The same contact by hand: corner 3 against the resting triangle.
  bool is_candidate = false;
  fcl::continuousCandidates(
      &resting, still, still, &bending, still, still,
      [&](const fcl::ContinuousCandidate* candidates, std::size_t count) {
        for (std::size_t i = 0; i < count; ++i)
          is_candidate |= candidates[i].kind == fcl::ContinuousContactKind::kVertexFace &&
                          candidates[i].vertices[0] == 3;
        return !is_candidate;
      });
  const Vector f0(-4, -4, 0), f1(4, -4, 0), f2(0, 4, 0);
  const auto test =
      fcl::vertexFace<S>(Vector(1, 0, 1), f0, f1, f2, corners[3], f0, f1, f2, 1e-6);
  const bool stages_ok =
      is_candidate && test.is_contact && test.toc_lo <= S(0.5) && test.toc_hi >= S(0.5);

  const bool ok = first_ok && all_ok && stages_ok;
  std::printf("%s  first contact at %.4f, %zu contact(s)\n", ok ? "ok    " : "FAILED",
              static_cast<double>(first.time_of_contact), all.contacts.size());
  return ok;
}

}  // namespace

int main() {
  const bool with_double = sheetsMeet<double>();
  const bool with_float = sheetsMeet<float>();
  return with_double && with_float ? 0 : 1;
}
